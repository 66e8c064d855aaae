use super::*;
use crate::segment::testing::area;
use image::Rgb;

/// A subject of `colour` in front of cloth of the key's colour, in light that falls to a third from left to right.
fn before_cloth(cloth: [u8; 3], colour: [u8; 3]) -> RgbImage {
    RgbImage::from_fn(120, 70, |x, y| {
        let light = 1.0 - 0.67 * f64::from(x) / 120.0;
        let is_subject = (40..60).contains(&x) && (20..60).contains(&y);
        Rgb(if is_subject { colour } else { cloth.map(|c| (f64::from(c) * light) as u8) })
    })
}

#[test]
fn cloth_of_the_keys_hue_is_background_in_any_light_and_other_colours_are_the_subject() {
    let (green, blue) = ([60, 170, 80], [30, 60, 180]);
    for (cloth, colour) in
        [(green, [210, 160, 130]), (green, [30, 30, 34]), (blue, [200, 200, 190]), (blue, green)]
    {
        let mask = ChromaKey::new(Key::new(cloth)).unwrap().segment(&before_cloth(cloth, colour)).unwrap();
        // The opening removes the corners.
        assert_eq!(area(&mask), 20.0 * 40.0 - 4.0, "{colour:?} before {cloth:?}");
    }
}

#[test]
fn grey_keys_and_invalid_tolerances_are_refused_with_the_found_value() {
    let error = |key| ChromaKey::new(key).unwrap_err().to_string();
    assert!(error(Key::new([120, 125, 118])).contains("nearly grey [120, 125, 118]"));
    let green = Key::new([60, 170, 80]);
    assert!(error(Key { hue_tolerance: f64::NAN, ..green }).contains("NaN"));
    assert!(error(Key { least_chroma: 1.0, ..green }).contains("found 0.5 and 1"));
}
