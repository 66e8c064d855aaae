//! Connected regions of a mask.

use image::GrayImage;

/// Which pixels count as neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Neighbours {
    /// Those to the left and right, above and below.
    Four,
    /// The diagonal ones too.
    Eight,
}

impl Neighbours {
    fn steps(self) -> &'static [(i32, i32)] {
        const ALL: [(i32, i32); 8] = [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)];
        match self {
            Self::Four => &ALL[..4],
            Self::Eight => &ALL,
        }
    }
}

/// Gives connected regions of `kind` (0 or 255) with fewer than `area_px` pixels to their surroundings.
pub(super) fn drop_small(mask: &mut GrayImage, kind: u8, area_px: u32, neighbours: Neighbours) {
    let (width, height) = (mask.width() as i32, mask.height() as i32);
    let index = |x: i32, y: i32| y as usize * width as usize + x as usize;
    let mut visited = vec![false; mask.len()];
    let mut region: Vec<(i32, i32)> = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        region.clear();
        let mut visit = |region: &mut Vec<(i32, i32)>, x: i32, y: i32| {
            let in_image = (0..width).contains(&x) && (0..height).contains(&y);
            if in_image && !visited[index(x, y)] && mask.as_raw()[index(x, y)] == kind {
                visited[index(x, y)] = true;
                region.push((x, y));
            }
        };
        visit(&mut region, x, y);
        let mut done = 0;
        while let Some(&(x, y)) = region.get(done) {
            neighbours.steps().iter().for_each(|(dx, dy)| visit(&mut region, x + dx, y + dy));
            done += 1;
        }
        if region.len() < area_px as usize {
            region.iter().for_each(|&(x, y)| mask.as_mut()[index(x, y)] = 255 - kind);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Luma;

    /// A mask from rows of `#` for subject.
    fn mask(rows: &[&str]) -> GrayImage {
        GrayImage::from_fn(rows[0].len() as u32, rows.len() as u32, |x, y| {
            Luma([if rows[y as usize].as_bytes()[x as usize] == b'#' { 255 } else { 0 }])
        })
    }

    fn dropped(rows: &[&str], kind: u8, area_px: u32, neighbours: Neighbours) -> GrayImage {
        let mut mask = mask(rows);
        drop_small(&mut mask, kind, area_px, neighbours);
        mask
    }

    #[test]
    fn regions_below_the_area_go_and_the_others_stay() {
        let rows = ["##...#", "##....", "....##"];
        assert_eq!(dropped(&rows, 255, 2, Neighbours::Four), mask(&["##....", "##....", "....##"]));
        assert_eq!(dropped(&rows, 255, 3, Neighbours::Four), mask(&["##....", "##....", "......"]));
        assert_eq!(dropped(&rows, 255, 0, Neighbours::Four), mask(&rows));
    }

    #[test]
    fn diagonal_neighbours_hold_a_region_together_where_they_count() {
        let rows = ["#..", ".#.", "..#"];
        assert_eq!(dropped(&rows, 255, 3, Neighbours::Eight), mask(&rows));
        assert_eq!(dropped(&rows, 255, 3, Neighbours::Four), mask(&["...", "...", "..."]));
    }

    #[test]
    fn small_holes_are_filled() {
        let rows = ["#####", "#.#.#", "###.#", "#####"];
        assert_eq!(dropped(&rows, 0, 2, Neighbours::Four), mask(&["#####", "###.#", "###.#", "#####"]));
    }

    #[test]
    fn an_image_without_pixels_stays() {
        drop_small(&mut GrayImage::new(0, 0), 255, 10, Neighbours::Eight);
    }
}
