use super::*;

#[test]
fn rows_leave_out_their_padding_and_the_last_needs_none() {
    let bytes: Vec<u8> = (0..13).collect();
    let view = MaskView::new(&bytes, (3, 3), 5).unwrap();
    assert_eq!(view.rows().collect::<Vec<_>>(), [[0, 1, 2], [5, 6, 7], [10, 11, 12]]);
    assert_eq!((view.size(), view.stride()), ((3, 3), 5));
}

#[test]
fn a_stride_below_the_width_and_missing_bytes_are_refused() {
    let error = |bytes: &[u8], size, stride| MaskView::new(bytes, size, stride).unwrap_err().to_string();
    let narrow = error(&[0; 100], (8, 8), 7);
    assert!(narrow.contains("at least the width of 8 pixels, found 7"), "{narrow}");
    let short = error(&[0; 76], (8, 8), 10);
    assert!(short.contains("at least 78 bytes") && short.contains("found 76"), "{short}");
    assert!(error(&[0; 76], (8, 8), usize::MAX / 4).contains("stride"));
}

#[test]
fn an_image_without_pixels_is_a_mask() {
    assert_eq!(MaskView::new(&[], (0, 0), 0).unwrap().rows().count(), 0);
    assert!(MaskView::new(&[], (0, 5), 0).unwrap().rows().all(<[u8]>::is_empty));
    assert_eq!(MaskView::new(&[], (5, 0), 5).unwrap().rows().count(), 0);
}
