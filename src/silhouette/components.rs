//! The connected components of a silhouette, and which of them lies at a pixel.
//!
//! Labels number the components in the order of their first pixels, row-major. Diagonal neighbours are connected. Pixels
//! beyond the image, and those that the lens did not see, belong to none.

use super::bit_image::{BitImage, WORD};
use super::regions::{Regions, Run};
use super::{Rect, Silhouette};

/// The label of a component.
pub(crate) type Label = usize;

/// A connected component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Component {
    /// In pixels.
    pub(crate) area: u32,
    /// The smallest rectangle that holds it.
    pub(crate) rect: Rect,
}

/// The connected components of a silhouette.
#[derive(Debug, Clone, Default)]
pub(crate) struct Components {
    /// In image coordinates, row-major, each with the label of its component.
    runs: Vec<(Run, Label)>,
    /// The first row with runs, the index of each row's first run from there on, and the number of runs.
    first_row: i32,
    rows: Vec<usize>,
    components: Vec<Component>,
}

impl Components {
    /// Finds the components of `silhouette`, of those pixels that are subject in `field_of_view` where there is one.
    pub(crate) fn new(silhouette: &Silhouette, field_of_view: Option<&Silhouette>) -> Self {
        let rect = silhouette.rect().intersection(&silhouette.image());
        if rect.is_empty() {
            return Self::default();
        }
        let bits = bits_of(silhouette, field_of_view, &rect);

        let (mut found, mut regions) = (Self { first_row: rect.y0, ..Self::default() }, Regions::default());
        let mut labels = Vec::new();
        for (number, (run, first)) in regions.runs_by_region(&bits).enumerate() {
            // A region's first run is the first of its runs that comes along.
            let label = if first == number { found.components.len() } else { labels[first] };
            labels.push(label);
            let run = Run {
                row: run.row + rect.y0 as u32,
                start: run.start + rect.x0 as u32,
                end: run.end + rect.x0 as u32,
            };
            found.runs.push((run, label));
            found.add_to_component(&run, label);
        }

        let row_of = |run: &Run| run.row as i32 - rect.y0;
        let rows = 0..=rect.height() as i32;
        found.rows = rows.map(|y| found.runs.partition_point(|(run, _)| row_of(run) < y)).collect();
        found
    }

    fn add_to_component(&mut self, run: &Run, label: Label) {
        let (y, start, end) = (run.row as i32, run.start as i32, run.end as i32);
        let rect = Rect { x0: start, y0: y, x1: end, y1: y + 1 };
        match self.components.get_mut(label) {
            Some(component) => {
                component.area += run.end - run.start;
                component.rect = component.rect.union(&rect);
            }
            None => self.components.push(Component { area: run.end - run.start, rect }),
        }
    }

    /// All components, by their labels.
    pub(crate) fn all(&self) -> &[Component] {
        &self.components
    }

    /// All runs, row-major, with the labels of their components.
    pub(crate) fn runs(&self) -> &[(Run, Label)] {
        &self.runs
    }

    /// The runs of image row `y`.
    fn row(&self, y: i32) -> &[(Run, Label)] {
        let Ok(row) = usize::try_from(y - self.first_row) else { return &[] };
        match self.rows.get(row..=row + 1) {
            Some(&[start, end]) => &self.runs[start..end],
            _ => &[],
        }
    }

    /// Calls `visit` with the label of each run that shares pixels with `run`, and their number.
    pub(crate) fn overlap(&self, run: &Run, mut visit: impl FnMut(Label, u32)) {
        let row = self.row(run.row as i32);
        let first = row.partition_point(|(own, _)| own.end <= run.start);
        for (own, label) in row[first..].iter().take_while(|(own, _)| own.start < run.end) {
            visit(*label, own.end.min(run.end) - own.start.max(run.start));
        }
    }

    /// The component nearest to pixel `(i, j)`, by the distance of pixel centres; `None` where none has a pixel whose row
    /// and column are within `reach`. Ties go to the lower row, then to the lower column.
    pub(crate) fn nearest(&self, i: i32, j: i32, reach: i32) -> Option<Label> {
        // The pixel itself is mostly subject.
        let runs_around = |y: i32| {
            let row = self.row(y);
            let after = row.partition_point(|(run, _)| run.end as i32 <= i);
            &row[after.saturating_sub(1)..row.len().min(after + 1)]
        };
        let is_at = |(run, _): &&(Run, Label)| run.start as i32 <= i && i < run.end as i32;
        if let Some((_, label)) = runs_around(j).iter().find(is_at) {
            return Some(*label);
        }

        let mut nearest: Option<(i64, Label)> = None;
        for y in j - reach..=j + reach {
            for (run, label) in runs_around(y) {
                let x = i.clamp(run.start as i32, run.end as i32 - 1);
                let (dx, dy) = (i64::from(x - i), i64::from(y - j));
                let square = dx * dx + dy * dy;
                if dx.abs() <= i64::from(reach) && nearest.is_none_or(|(least, _)| square < least) {
                    nearest = Some((square, *label));
                }
            }
        }
        nearest.map(|(_, label)| label)
    }
}

/// The subject pixels of `rect`.
fn bits_of(silhouette: &Silhouette, field_of_view: Option<&Silhouette>, rect: &Rect) -> BitImage {
    let mut bits = BitImage::default();
    bits.resize(rect.width(), rect.height());
    let (stride, last_word) = (bits.stride(), bits.last_word());
    for (index, word) in bits.words_mut().iter_mut().enumerate() {
        let (k, y) = (index % stride, rect.y0 + (index / stride) as i32);
        let x = rect.x0 + (k * WORD) as i32;
        let word_of = |image: &Silhouette| {
            let [low, high] = [x, x + 32].map(|x| u64::from(image.subject_word(x, y)));
            low | high << 32
        };
        *word = word_of(silhouette);
        if let Some(field_of_view) = field_of_view.filter(|_| *word != 0) {
            *word &= word_of(field_of_view);
        }
        if k + 1 == stride {
            *word &= last_word;
        }
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::silhouette::Border;
    use image::{GrayImage, Luma};
    use imageproc::region_labelling::{Connectivity, connected_components};
    use ode_visual_hull_random::Random;

    /// Masks of any width whose pixels are subject with a probability: specks, large regions, and all between.
    fn random_masks() -> impl Iterator<Item = GrayImage> {
        let mut random = Random(7);
        (0..60).map(move |k| {
            let (width, height) = (1 + random.below(150_u32), 1 + random.below(40_u32));
            let share = f64::from(k % 6 + 1) / 7.0;
            GrayImage::from_fn(width, height, |_, _| Luma([if random.unit() < share { 255 } else { 0 }]))
        })
    }

    fn components(mask: &GrayImage) -> Components {
        Components::new(&Silhouette::new(mask, Border::Background), None)
    }

    #[test]
    fn labels_are_those_of_imageproc() {
        for mask in random_masks() {
            let reference = connected_components(&mask, Connectivity::Eight, Luma([0]));
            let found = components(&mask);
            for (i, j, Luma([number])) in reference.enumerate_pixels() {
                let label = found.nearest(i as i32, j as i32, 0).map_or(0, |label| label as u32 + 1);
                assert_eq!(label, *number, "pixel ({i}, {j})");
            }

            let count = reference.iter().copied().max().unwrap_or(0) as usize;
            assert_eq!(found.all().len(), count);
            for (label, component) in found.all().iter().enumerate() {
                let pixels =
                    reference.enumerate_pixels().filter(|(_, _, Luma([n]))| *n as usize == label + 1);
                let rects = pixels.map(|(i, j, _)| Rect::window(i as i32, j as i32, 0));
                let (area, rect) =
                    rects.fold((0, Rect::EMPTY), |(area, rect), pixel| (area + 1, rect.union(&pixel)));
                assert_eq!(*component, Component { area, rect });
            }
        }
    }

    #[test]
    fn the_nearest_component_is_that_of_the_nearest_pixel() {
        for mask in random_masks().step_by(6) {
            let found = components(&mask);
            let subject: Vec<(i32, i32)> = mask
                .enumerate_pixels()
                .filter(|(_, _, Luma([byte]))| *byte > 0)
                .map(|(i, j, _)| (i as i32, j as i32))
                .collect();
            for (j, i) in (-4..mask.height() as i32 + 4).flat_map(|j| (-4..40).map(move |i| (j, i))) {
                let near = subject.iter().filter(|(x, y)| (x - i).abs().max((y - j).abs()) <= 3);
                let nearest = near.min_by_key(|(x, y)| ((x - i).pow(2) + (y - j).pow(2), *y, *x));
                let expected = nearest.and_then(|&(x, y)| found.nearest(x, y, 0));
                assert_eq!(found.nearest(i, j, 3), expected, "pixel ({i}, {j})");
            }
        }
    }

    #[test]
    fn overlaps_are_the_pixels_shared() {
        let masks: Vec<GrayImage> = random_masks().collect();
        for pair in masks.windows(2) {
            let [a, b] = [&pair[0], &pair[1]].map(components);
            let mut shared = 0;
            a.runs().iter().for_each(|(run, _)| b.overlap(run, |_, pixels| shared += pixels));
            let is_shared = |(i, j): (u32, u32)| {
                let is_subject = |mask: &GrayImage| mask.get_pixel_checked(i, j).is_some_and(|p| p.0[0] > 0);
                is_subject(&pair[0]) && is_subject(&pair[1])
            };
            let pixels = (0..40).flat_map(|j| (0..150).map(move |i| (i, j)));
            assert_eq!(shared as usize, pixels.filter(|&pixel| is_shared(pixel)).count());
        }
    }

    #[test]
    fn pixels_that_nothing_saw_connect_no_parts() {
        // Two bars that touch the left border of the image, beyond which all is unknown, and a column that the lens did
        // not see.
        let mask = GrayImage::from_fn(40, 12, |_, j| Luma([if (j / 3).is_multiple_of(2) { 255 } else { 0 }]));
        let silhouette = Silhouette::new(&mask, Border::Unknown);
        assert_eq!(Components::new(&silhouette, None).all().len(), 2);

        let seen = GrayImage::from_fn(40, 12, |i, _| Luma([if i == 20 { 0 } else { 255 }]));
        let seen = Silhouette::new(&seen, Border::Background);
        assert_eq!(Components::new(&silhouette, Some(&seen)).all().len(), 4);
    }
}
