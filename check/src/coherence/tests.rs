use super::*;
use image::{GrayImage, Luma};
use nalgebra::Isometry3;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, layout, silhouette};

/// Four cameras around a ball of 0.6 m.
fn cameras() -> Vec<Camera> {
    layout::staggered(4, 3.0, &[0.5, 1.5], Point3::new(0.0, 0.0, 1.0), (160, 160), 0.5).unwrap()
}

fn masks(cameras: &[Camera]) -> Vec<GrayImage> {
    let ball = Solid::sphere(0.3).unwrap();
    let ball = Placed::new(ball, Isometry3::translation(0.0, 0.0, 1.0), Texture::plain([0; 3]));
    let ball = Subject::new(vec![ball]);
    cameras.iter().map(|camera| silhouette(camera, &ball)).collect()
}

fn coherence(cameras: &[Camera], masks: &[GrayImage]) -> Vec<SilhouetteCoherence> {
    let data = HullData::new();
    data.add_views(cameras).unwrap();
    data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 2.0)).unwrap()).unwrap();
    masks.iter().enumerate().for_each(|(view, mask)| data.set_mask(view, mask).unwrap());
    silhouette_coherence(&data.update(0.0).unwrap(), 1)
}

#[test]
fn the_hull_of_exact_silhouettes_fills_them() {
    let cameras = cameras();
    for view in coherence(&cameras, &masks(&cameras)) {
        // Rays of pixels at the very edge may pass a hull that is made of pixels.
        assert!(view.pixels > 2000 && view.filled_share() > 0.96, "{view:?}");
        assert!(view.carved_depth_px <= 2.0, "{view:?}");
    }
}

#[test]
fn the_view_that_lost_a_part_carves_the_others() {
    let cameras = cameras();
    let mut masks = masks(&cameras);

    // The lower third of the ball, some 20 rows.
    let rows: Vec<u32> = (0..160).filter(|&y| (0..160).any(|x| masks[2].get_pixel(x, y).0[0] > 0)).collect();
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let from = last - (last - first) / 3;
    (from..=last).for_each(|y| (0..160).for_each(|x| masks[2].put_pixel(x, y, Luma([0]))));

    let coherence = coherence(&cameras, &masks);
    assert!(coherence[2].filled_share() > 0.9, "the hull fills it: {:?}", coherence[2]);
    for view in [0, 1, 3] {
        assert!(
            coherence[view].filled_share() < 0.9
                && coherence[view].carved_pixels < coherence[2].carved_pixels / 4,
            "{:?}",
            coherence[view]
        );
    }

    // Half of what is missing lies at least a few pixels inside the part, and none deeper than the part is high.
    let height = f64::from(last - from + 1);
    assert!(
        coherence[2].carved_depth_px > 2.0 && coherence[2].carved_depth_px < height,
        "{:?}",
        coherence[2]
    );
}

#[test]
fn an_empty_hull_fills_nothing() {
    let cameras = cameras();
    let mut masks = masks(&cameras);
    masks[1] = GrayImage::new(160, 160);
    let coherence = coherence(&cameras, &masks);
    assert_eq!((coherence[1].pixels, coherence[1].filled_share()), (0, 1.0));
    assert!(
        [0, 2, 3]
            .iter()
            .all(|&view| coherence[view].filled_pixels == 0 && coherence[view].carved_pixels == 0)
    );
    assert!(coherence[1].carved_pixels > 0, "without it the others agree");
}
