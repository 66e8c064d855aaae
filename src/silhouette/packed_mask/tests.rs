use super::*;
use crate::silhouette::{Border, Silhouette};
use image::Luma;
use ode_visual_hull_random::Random;

/// Widths below, at and above a word, and images without pixels.
const SIZES: [(u32, u32); 8] = [(0, 0), (0, 3), (3, 0), (1, 1), (63, 5), (64, 5), (65, 7), (200, 130)];

/// Discs with and without coverage along their outlines, noise, an empty and a full mask.
fn masks((width, height): (u32, u32)) -> Vec<GrayImage> {
    let mut random = Random(u64::from(width) << 32 | u64::from(height) | 1);
    let mut masks = Vec::new();
    for softness in [1e-9, 2.0] {
        let centre = [width, height].map(|side| f64::from(side) * random.unit());
        let radius = 0.5 * f64::from(width.max(height)) * random.unit();
        masks.push(GrayImage::from_fn(width, height, |x, y| {
            let inside = radius - (f64::from(x) - centre[0]).hypot(f64::from(y) - centre[1]);
            Luma([(127.5 + 127.5 * inside / softness) as u8])
        }));
    }

    masks.push(GrayImage::from_fn(width, height, |_, _| Luma([(255.0 * random.unit()) as u8])));
    masks.push(GrayImage::new(width, height));
    masks.push(GrayImage::from_pixel(width, height, Luma([255])));
    masks
}

#[test]
fn packing_keeps_every_byte_in_reused_memory_too() {
    let (mut packed, mut bytes) = (PackedMask::default(), GrayImage::new(9, 9));
    for mask in SIZES.into_iter().flat_map(masks) {
        packed.pack(&mask);
        assert_eq!(packed, PackedMask::new(&mask));
        packed.write_to(&mut bytes);
        assert_eq!(bytes, mask);
        assert_eq!(packed.has_coverage(), mask.iter().any(|byte| !matches!(byte, 0 | 255)));
        assert_eq!(packed.is_full(), mask.iter().all(|&byte| byte >= SUBJECT));
    }
}

#[test]
fn padded_rows_are_packed_like_rows_without_padding() {
    for mask in SIZES.into_iter().flat_map(masks) {
        let (width, stride) = (mask.width() as usize, mask.width() as usize + 7);
        let mut bytes = vec![77; stride * mask.height() as usize];
        for (row, from) in bytes.chunks_mut(stride).zip(mask.chunks(width.max(1))) {
            row[..width].copy_from_slice(from);
        }

        let view = MaskView::new(&bytes, mask.dimensions(), stride).unwrap();
        assert_eq!(PackedMask::new(view), PackedMask::new(&mask));
    }
}

#[test]
fn the_rectangle_is_the_tightest_around_the_subject() {
    for mask in SIZES.into_iter().flat_map(masks) {
        let subject = mask.enumerate_pixels().filter(|(.., byte)| byte.0[0] >= SUBJECT);
        let expected = subject.fold(None, |rect: Option<Rect>, (x, y, _)| {
            let (x, y) = (x as i32, y as i32);
            let Rect { x0, y0, x1, y1 } = rect.unwrap_or(Rect { x0: x, y0: y, x1: x, y1: y });
            Some(Rect { x0: x0.min(x), y0: y0.min(y), x1: x1.max(x + 1), y1: y1.max(y + 1) })
        });
        assert_eq!(PackedMask::new(&mask).rect(), expected.unwrap_or(Rect::EMPTY));
    }
}

#[test]
fn a_binary_mask_keeps_only_which_pixels_are_subject() {
    for mask in SIZES.into_iter().flat_map(masks) {
        let mut binary = mask.clone();
        binary.iter_mut().for_each(|byte| *byte = if *byte >= SUBJECT { 255 } else { 0 });
        assert_eq!(PackedMask::new(&mask).binary(), PackedMask::new(&binary));
    }
}

#[test]
fn a_silhouette_holds_the_bytes_of_the_mask_around_its_subject() {
    for mask in SIZES.into_iter().flat_map(masks) {
        for border in [Border::Background, Border::Unknown] {
            let silhouette = Silhouette::new(&mask, border);
            let beyond = if border == Border::Unknown { 255 } else { 0 };

            let kept = silhouette.rect().grown(8);
            for (i, j) in (kept.y0..kept.y1).flat_map(|j| (kept.x0..kept.x1).map(move |i| (i, j))) {
                let pixel = u32::try_from(i).ok().zip(u32::try_from(j).ok());
                let byte =
                    pixel.and_then(|(i, j)| mask.get_pixel_checked(i, j)).map_or(beyond, |byte| byte.0[0]);
                assert_eq!(silhouette.value(i, j), byte, "({i}, {j}) of {:?}", mask.dimensions());
                assert_eq!(silhouette.is_subject(i, j), byte >= SUBJECT);
            }
        }
    }
}
