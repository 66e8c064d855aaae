use super::*;
use image::{GrayAlphaImage, LumaA, Rgb, RgbImage, Rgba, RgbaImage};

/// An image whose left pixel is `a` and whose right one is `b`.
fn pair<P: image::Pixel>(a: P, b: P) -> ImageBuffer<P, Vec<P::Subpixel>> {
    ImageBuffer::from_fn(2, 1, |x, _| if x == 0 { a } else { b })
}

fn values(image: impl Into<DynamicImage>) -> Vec<u8> {
    mask_of(image.into()).unwrap().into_raw()
}

fn refusal(image: impl Into<DynamicImage>) -> String {
    mask_of(image.into()).unwrap_err()
}

#[test]
fn a_grey_image_is_the_mask_itself() {
    let all = GrayImage::from_fn(256, 1, |x, _| Luma([x as u8]));
    assert_eq!(mask_of(all.clone().into()).unwrap(), all);
}

#[test]
fn an_image_with_transparency_gives_its_alpha_channel() {
    let cut_out: RgbaImage = pair(Rgba([255, 255, 255, 0]), Rgba([0, 0, 0, 200]));
    assert_eq!(values(cut_out), [0, 200]);
    let grey: GrayAlphaImage = pair(LumaA([255, 3]), LumaA([0, 255]));
    assert_eq!(values(grey), [3, 255]);
}

#[test]
fn an_opaque_colour_image_gives_its_luma() {
    let opaque: RgbaImage = pair(Rgba([255, 255, 255, 255]), Rgba([0, 0, 0, 255]));
    assert_eq!(values(opaque), [255, 0]);
    let colour: RgbImage = pair(Rgb([255, 255, 255]), Rgb([90, 90, 90]));
    assert_eq!(values(colour), [255, 90]);
}

#[test]
fn sixteen_bits_are_scaled_to_eight() {
    let grey: Gray16 = pair(Luma([65_535]), Luma([128 * 257]));
    assert_eq!(values(grey), [255, 128]);
    let cut_out = pair(Rgba([0_u16, 0, 0, 65_535]), Rgba([65_535, 0, 0, 7 * 257]));
    assert_eq!(values(cut_out), [255, 7]);
}

#[test]
fn an_empty_mask_is_a_mask() {
    assert_eq!(values(GrayImage::new(2, 1)), [0, 0]);
}

#[test]
fn masks_that_would_count_as_empty_are_refused() {
    let grey: GrayImage = pair(Luma([1]), Luma([0]));
    assert_eq!(refusal(grey), "expected 0 .. 255, found a greatest value of 1; multiply by 255");
    let colour: RgbImage = pair(Rgb([1, 1, 1]), Rgb([0, 0, 0]));
    assert!(refusal(colour).contains("multiply by 255"));
    let alpha: RgbaImage = pair(Rgba([9, 9, 9, 1]), Rgba([9, 9, 9, 0]));
    assert!(refusal(alpha).contains("multiply by 255"));
    let deep: Gray16 = pair(Luma([1]), Luma([0]));
    assert!(refusal(deep).contains("multiply by 65535"));
    let eight_in_sixteen: Gray16 = pair(Luma([255]), Luma([0]));
    assert!(refusal(eight_in_sixteen).contains("greatest value of 255; save it with 8 bits"));
}

#[test]
fn a_file_that_is_missing_or_no_image_is_named() {
    let missing = load_mask("/nowhere/mask.png").unwrap_err().to_string();
    assert!(missing.starts_with("/nowhere/mask.png: expected an image"), "{missing}");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    let no_image = load_mask(source).unwrap_err().to_string();
    assert!(no_image.contains("Cargo.toml: expected an image (png, jpeg or pnm), found"), "{no_image}");
}
