use super::super::tests::{Random, bounds, cameras};
use super::*;
use image::Luma;
use nalgebra::Point3;

/// A disc that moves from frame to frame; the last view gets a new mask in every third frame only.
fn show(data: &HullData, frame: u32) -> Arc<Hull> {
    let views = data.view_count();
    for view in (0..views).filter(|view| view + 1 < views || frame.is_multiple_of(3)) {
        let mask = GrayImage::from_fn(160, 120, |i, j| {
            let (x, y) = (f64::from(i) - 60.0 - 2.0 * f64::from(frame), f64::from(j) - 60.0);
            Luma([if x.hypot(y) < 30.0 + f64::from(frame) { 255 } else { 0 }])
        });
        data.set_mask(view, &mask).unwrap();
    }
    data.update(0.03 * f64::from(frame)).unwrap()
}

/// All that is asked of a frame: verdicts, and a distance in each view.
fn answers(hull: &Hull, points: &[Point3<f64>]) -> Vec<(bool, Vec<u16>)> {
    let distance = |p: &Point3<f64>, view: &super::super::View| {
        view.pixel(p).map_or(0, |(i, j)| view.silhouette().distance(i, j))
    };
    let distances = |p| hull.views().iter().map(|view| distance(p, view)).collect();
    points.iter().map(|p| (hull.inside(p), distances(p))).collect()
}

#[test]
fn past_frames_answer_as_they_did_whether_held_or_looked_back_at() {
    let data = HullData::new();
    data.add_views(&cameras()).unwrap();
    data.set_bounds(bounds()).unwrap();
    let mut random = Random(17);
    let points: Vec<_> = (0..500).map(|_| random.point(&bounds())).collect();
    let (mut told, mut held) = (Vec::new(), Vec::new());
    for frame in 0..24 {
        let hull = show(&data, frame);
        told.push(answers(&hull, &points));
        if frame % 5 == 2 {
            held.push((frame as usize, hull));
        }
        assert!(held.iter().all(|(frame, hull)| answers(hull, &points) == told[*frame]));
        // Nobody looks back before frame 11, and some do from then on.
        if frame >= 11 && frame % 4 == 3 {
            let history = data.history();
            assert_eq!(history.len(), 5);
            for (past, hull) in history.iter().rev().enumerate() {
                assert_eq!(answers(hull, &points), told[frame as usize - past], "{frame} - {past}");
            }
        }
    }
    assert!(told.windows(2).all(|two| two[0] != two[1]));
    assert!(told.iter().all(|answers| answers.iter().any(|answer| answer.0)));
}
