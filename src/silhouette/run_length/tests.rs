use super::*;
use image::{GrayImage, Luma};
use ode_visual_hull_random::Random;

const SIZES: [(u32, u32); 9] =
    [(0, 0), (0, 3), (3, 0), (1, 1), (63, 5), (64, 5), (65, 7), (128, 9), (203, 131)];

/// Rings with sharp and soft outlines, some with scattered coverage; noise; and masks of a single value.
fn masks((width, height): (u32, u32)) -> Vec<GrayImage> {
    let mut random = Random(u64::from(width * 1000 + height));
    let mut masks = Vec::new();
    for softness in [1e-9, 0.7, 2.0] {
        let centre = [width, height].map(|side| f64::from(side) * random.unit());
        let radius = f64::from(width.max(height)) * random.between(0.1, 0.5);
        masks.push(GrayImage::from_fn(width, height, |x, y| {
            let distance = (f64::from(x) - centre[0]).hypot(f64::from(y) - centre[1]);
            let inside = (radius - distance).min(distance - 0.4 * radius);
            let is_speck = softness > 1.0 && random.unit() < 0.01;
            Luma([if is_speck { random.below(256) as u8 } else { (127.5 + 127.5 * inside / softness) as u8 }])
        }));
    }

    masks.push(GrayImage::from_fn(width, height, |_, _| Luma([random.below(256) as u8])));
    masks.extend([0, 1, 254, 255].map(|value| GrayImage::from_pixel(width, height, Luma([value]))));
    masks
}

#[test]
fn a_mask_is_decoded_as_it_was_encoded_with_and_without_coverage() {
    let mut reused = PackedMask::default();
    for mask in SIZES.into_iter().flat_map(masks) {
        let packed = PackedMask::new(&mask);
        assert_eq!(PackedMask::decode(&packed.encode().unwrap()).unwrap(), packed);
        reused.decode_from(&packed.encode_binary().unwrap()).unwrap();
        assert_eq!(reused, packed.binary());
    }
}

#[test]
fn an_outline_takes_about_three_bits_a_row_and_end() {
    let disc = GrayImage::from_fn(640, 480, |x, y| {
        let distance = (f64::from(x) - 300.0).hypot(f64::from(y) - 240.0);
        Luma([if distance < 150.0 { 255 } else { 0 }])
    });
    // Each of 300 rows has two ends and a bit of its own. A disc's ends move by less than a pixel in most rows.
    let length = PackedMask::new(&disc).encode().unwrap().len();
    assert!(length < HEADER + 300 * 7 / 8, "{length}");
}

/// Checks that bytes are refused, or decoded to a mask that can be encoded and decoded again.
fn check(bytes: &[u8]) {
    if let Ok(mask) = PackedMask::decode(bytes) {
        assert_eq!(PackedMask::decode(&mask.encode().unwrap()).unwrap(), mask);
    }
}

#[test]
fn bytes_that_end_early_or_continue_after_the_last_row_are_refused() {
    for mask in SIZES.into_iter().flat_map(masks) {
        let bytes = PackedMask::new(&mask).encode().unwrap();
        for end in (0..bytes.len()).step_by(1 + bytes.len() / 200) {
            let error = PackedMask::decode(&bytes[..end]).unwrap_err().to_string();
            assert!(error.contains("found an end after") || error.contains("VHR1"), "{error}");
        }
        let longer = [&bytes[..], &[0]].concat();
        assert!(PackedMask::decode(&longer).unwrap_err().to_string().contains("found 1 more"));
    }
}

#[test]
fn changed_bytes_never_panic() {
    let mut random = Random(3);
    for mask in SIZES.into_iter().flat_map(masks) {
        let bytes = PackedMask::new(&mask).encode().unwrap();
        for _ in 0..100 {
            let mut changed = bytes.clone();
            for _ in 0..1 + random.below(3) {
                // Half of the changes are in the header or the first rows.
                let end = if random.unit() < 0.5 { HEADER + 8 } else { changed.len() };
                let index = random.below(changed.len().min(end));
                changed[index] = random.below(256) as u8;
            }

            check(&changed);
        }
    }
}

#[test]
fn an_error_names_the_field_that_is_wrong() {
    let error = |bytes: &[u8]| PackedMask::decode(bytes).unwrap_err().to_string();
    let mut bytes = PackedMask::new(&GrayImage::from_pixel(9, 7, Luma([255]))).encode().unwrap();

    assert!(error(b"\x89PNG....").contains("expected bytes that begin with \"VHR1\""));
    bytes[4] = 2;
    assert!(error(&bytes).contains("flags of 0 or 1, found 2"));
    bytes[4] = 0;
    bytes[9] = 8;
    bytes[11] = 10;
    assert!(error(&bytes).contains("found columns 8..10 and rows 0..7"));

    // More ends of runs than columns: a unary number of eight zeros, then a one.
    bytes[9] = 0;
    bytes[11] = 9;
    bytes[HEADER..].fill(0);
    bytes[HEADER + 1] = 0b1000_0000;
    assert!(error(&bytes).contains("row 0: expected at most 10 ends of runs"), "{}", error(&bytes));
}

#[test]
fn a_few_bytes_cannot_demand_gigabytes_of_memory() {
    let mut bytes = MARK.to_vec();
    bytes.push(0);
    bytes.extend([0xff; 4]);
    bytes.extend([0; 8]);
    let error = PackedMask::decode(&bytes).unwrap_err().to_string();
    assert!(error.contains("at most 2^28 pixels, found 65535 x 65535"), "{error}");
}

#[test]
fn after_an_error_the_mask_is_empty() {
    let bytes = PackedMask::new(&GrayImage::from_pixel(9, 7, Luma([200]))).encode().unwrap();
    let mut mask = PackedMask::default();
    mask.decode_from(&bytes).unwrap();
    assert!(mask.decode_from(&bytes[..bytes.len() - 1]).is_err());
    assert_eq!(mask, PackedMask::default());
}
