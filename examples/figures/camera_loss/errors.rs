//! The stack on masks and cameras with gross errors: speckle, a bite out of one mask, a principal point that is off.

use super::{RATE, SETTLE, Stage};
use crate::studio::*;
use image::{GrayImage, Luma};
use nalgebra::point;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Motion;
use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::random::Random;

/// Frames with errors: three seconds.
const FRAMES: usize = (3.0 * RATE) as usize;

/// How far a box of a stack that stands may be from its place, in millimetres.
const STANDS: f64 = 50.0;

/// The camera with errors, where only one has some.
const CAMERA: usize = 2;

/// Changes the mask of a view in a frame, counted from the first one with errors.
type Spoil = fn(&Camera, usize, usize, &GrayImage) -> GrayImage;

pub(super) fn figures(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let cameras = level_ring(TOP);
    let clean = |_: &Camera, _, _, mask: &GrayImage| mask.clone();
    let mut shifted = cameras.clone();
    shifted[CAMERA] = with_high_principal_point(&cameras[CAMERA], 2.0);

    let cases: [(&str, &[Camera], Spoil); 5] = [
        ("clean", &cameras, clean),
        ("speckle_5", &cameras, |_, view, frame, mask| speckled(mask, 0.05, (frame * 16 + view) as u64)),
        ("bite_10", &cameras, |camera, view, _, mask| bitten_in(camera, view, mask)),
        ("bite_10_flicker", &cameras, |camera, view, frame, mask| {
            if frame.is_multiple_of(2) { bitten_in(camera, view, mask) } else { mask.clone() }
        }),
        ("calibration_2px", &shifted, clean),
    ];

    let mut figures = Vec::new();
    for (name, calibrated, spoil) in cases {
        for (motion, suffix) in [(Motion::Held, ""), (Motion::Interpolated, "_interpolated")] {
            progress(&format!("a stack and {name}, {motion:?}"));
            let mut stage = Stage::new(&cameras, calibrated, motion);
            stage.add_stack();
            stage.play(SETTLE, |_, clean| Some(clean.clone()));

            let (start, mut drawn) = (stage.places(), 0);
            let fastest = stage.play(FRAMES, |view, clean| {
                let frame = drawn / cameras.len();
                drawn += 1;
                Some(spoil(&cameras[view], view, frame, clean))
            });
            let drift = stage.shifts(&start).into_iter().fold(0.0, f64::max);

            let mut add = |what: &str, value| {
                figures.push(Figure::reported(&format!("{name}_stack_{what}{suffix}"), value));
            };
            add("speed_m_s", fastest);
            add("drift_mm", drift);
            add("stands", f64::from(drift < STANDS));
        }
    }
    figures
}

/// A mask with a share of its pixels flipped.
fn speckled(mask: &GrayImage, share: f64, seed: u64) -> GrayImage {
    let mut random = Random(seed << 32);
    let mut speckled = mask.clone();
    for byte in speckled.iter_mut() {
        if random.unit() < share {
            *byte = 255 - *byte;
        }
    }
    speckled
}

/// The mask, which in the view [`CAMERA`] lacks a disc of a tenth of the subject's area, about the middle of the
/// table's top, where the stack stands.
fn bitten_in(camera: &Camera, view: usize, mask: &GrayImage) -> GrayImage {
    if view != CAMERA {
        return mask.clone();
    }

    let area = mask.iter().map(|&byte| f64::from(byte) / 255.0).sum::<f64>();
    let radius = (0.1 * area / std::f64::consts::PI).sqrt();
    let centre = camera.project(&point![0.0, 0.0, TOP]).expect("the camera looks at the table");
    GrayImage::from_fn(mask.width(), mask.height(), |i, j| {
        let distance = (f64::from(i) + 0.5 - centre.u).hypot(f64::from(j) + 0.5 - centre.v);
        if distance < radius { Luma([0]) } else { *mask.get_pixel(i, j) }
    })
}

/// The camera with a principal point that is some pixels too high in the image: it shows the table's top too low, and no
/// other view makes up for it.
fn with_high_principal_point(camera: &Camera, pixels: f64) -> Camera {
    let mut intrinsics = *camera.intrinsics();
    intrinsics[(1, 2)] -= pixels;
    Camera::new(camera.name(), camera.size(), intrinsics, *camera.lens(), *camera.cam_from_world())
        .expect("a camera much like this one")
}
