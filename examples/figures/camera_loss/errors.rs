//! The stack on masks and cameras with gross errors: speckle, a bite out of one mask, a principal point that is off.

use super::{RATE, SETTLE, Stage};
use crate::studio::*;
use image::GrayImage;
use nalgebra::point;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{HullData, MaskFilter, Motion};
use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::mask_errors::{bitten, speckled};

/// Frames with errors: three seconds.
const FRAMES: usize = (3.0 * RATE) as usize;

/// How far a box of a stack that stands may be from its place, in millimetres.
const STANDS: f64 = 50.0;

/// The camera with errors, where only one has some.
const CAMERA: usize = 2;

/// What is done against the errors.
#[derive(Debug, Clone, Copy)]
struct Correction {
    smallest_hole_px: u32,
    /// In metres.
    overrule_depth: Option<f64>,
}

impl Correction {
    fn apply(&self, data: &HullData) {
        let filter = MaskFilter { smallest_hole_px: self.smallest_hole_px, ..MaskFilter::default() };
        data.set_mask_filter(filter).expect("a filter");
        data.set_overrule_depth(self.overrule_depth).expect("a depth");
    }
}

/// Changes the mask of a view in a frame, counted from the first one with errors.
type Spoil = fn(&Camera, usize, usize, &GrayImage) -> GrayImage;

pub(super) fn figures(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let cameras = level_ring(TOP);
    let clean = |_: &Camera, _, _, mask: &GrayImage| mask.clone();
    let mut shifted = cameras.clone();
    shifted[CAMERA] = with_high_principal_point(&cameras[CAMERA], 2.0);

    let speckle: Spoil = |_, view, frame, mask| speckled(mask, 0.05, (frame * 16 + view) as u64);
    let bite: Spoil = |camera, view, _, mask| bitten_in(camera, view, mask);
    let flicker: Spoil = |camera, view, frame, mask| {
        if frame.is_multiple_of(2) { bitten_in(camera, view, mask) } else { mask.clone() }
    };
    let uncorrected = Correction { smallest_hole_px: 0, overrule_depth: None };
    let filled = Correction { smallest_hole_px: 2000, ..uncorrected };
    let overruled = Correction { overrule_depth: Some(0.02), ..uncorrected };
    let cases: [(&str, &[Camera], Spoil, Correction); 9] = [
        ("clean", &cameras, clean, uncorrected),
        ("clean_overruled", &cameras, clean, overruled),
        ("speckle_5", &cameras, speckle, uncorrected),
        ("speckle_5_filled", &cameras, speckle, filled),
        ("bite_10", &cameras, bite, uncorrected),
        ("bite_10_overruled", &cameras, bite, overruled),
        ("bite_10_flicker", &cameras, flicker, uncorrected),
        ("bite_10_flicker_overruled", &cameras, flicker, overruled),
        ("calibration_2px", &shifted, clean, uncorrected),
    ];

    let mut figures = Vec::new();
    for (name, calibrated, spoil, correction) in cases {
        for (motion, suffix) in [(Motion::Held, ""), (Motion::Interpolated, "_interpolated")] {
            progress(&format!("a stack and {name}, {motion:?}"));
            let mut stage = Stage::new(&cameras, calibrated, motion);
            correction.apply(&stage.data);
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

/// The mask, which in the view [`CAMERA`] lacks a disc of a tenth of the subject's area, about the middle of the
/// table's top, where the stack stands.
fn bitten_in(camera: &Camera, view: usize, mask: &GrayImage) -> GrayImage {
    if view != CAMERA {
        return mask.clone();
    }

    let centre = camera.project(&point![0.0, 0.0, TOP]).expect("the camera looks at the table");
    bitten(mask, 0.1, &point![centre.u, centre.v])
}

/// The camera with a principal point that is some pixels too high in the image: it shows the table's top too low, and no
/// other view makes up for it.
fn with_high_principal_point(camera: &Camera, pixels: f64) -> Camera {
    let mut intrinsics = *camera.intrinsics();
    intrinsics[(1, 2)] -= pixels;
    Camera::new(camera.name(), camera.size(), intrinsics, *camera.lens(), *camera.cam_from_world())
        .expect("a camera much like this one")
}
