//! Rectangles of whole pixels.

/// The pixels `x0 <= i < x1`, `y0 <= j < y1`; empty unless both upper bounds exceed their lower ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rect {
    /// First column.
    pub x0: i32,
    /// First row.
    pub y0: i32,
    /// One past the last column.
    pub x1: i32,
    /// One past the last row.
    pub y1: i32,
}

impl Rect {
    /// A rectangle without pixels.
    pub const EMPTY: Self = Self { x0: 0, y0: 0, x1: 0, y1: 0 };

    /// All pixels of an image.
    pub fn of_image(width: u32, height: u32) -> Self {
        Self { x0: 0, y0: 0, x1: width as i32, y1: height as i32 }
    }

    /// Whether it holds no pixel.
    pub fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        (self.x1 - self.x0).max(0) as usize
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        (self.y1 - self.y0).max(0) as usize
    }

    /// Whether pixel `(i, j)` lies in it.
    pub fn contains(&self, i: i32, j: i32) -> bool {
        self.x0 <= i && i < self.x1 && self.y0 <= j && j < self.y1
    }

    /// Index of pixel `(i, j)` in a row-major table over the rectangle.
    pub fn index(&self, i: i32, j: i32) -> usize {
        (j - self.y0) as usize * self.width() + (i - self.x0) as usize
    }

    /// The rectangle grown by `margin` pixels on every side; an empty one stays empty.
    pub fn grown(&self, margin: i32) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self { x0: self.x0 - margin, y0: self.y0 - margin, x1: self.x1 + margin, y1: self.y1 + margin }
    }

    /// The pixels that lie in both.
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        }
    }

    /// The smallest rectangle that holds both; an empty one adds nothing.
    pub fn union(&self, other: &Self) -> Self {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => *other,
            (_, true) => *self,
            _ => Self {
                x0: self.x0.min(other.x0),
                y0: self.y0.min(other.y0),
                x1: self.x1.max(other.x1),
                y1: self.y1.max(other.y1),
            },
        }
    }

    /// The square of half-width `half` around pixel `(i, j)`.
    pub fn window(i: i32, j: i32, half: i32) -> Self {
        Self {
            x0: i.saturating_sub(half),
            y0: j.saturating_sub(half),
            x1: i.saturating_add(half).saturating_add(1),
            y1: j.saturating_add(half).saturating_add(1),
        }
    }
}
