//! Pictures from the place of each real camera beside what that camera saw.

use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::hull::Aabb;
use ode_visual_hull_film::VolumeOptions;
use ode_visual_hull_testing::captures::{self, BALANCING, SEATED};
use ode_visual_hull_testing::figure::Bound::AtLeast;
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_viewer::metrics::{Comparison, Truth};
use ode_visual_hull_viewer::record::CapturedFrames;
use ode_visual_hull_viewer::scene::Scene;
use ode_visual_hull_viewer::{DrawOptions, Method, Renderer, RendererKind};

/// A recorded frame and what is asked of its pictures.
struct Capture {
    name: &'static str,
    folder: &'static str,
    frame: u32,
    bounds: Aabb,
    psnr: f64,
    ssim: f64,
    iou: f64,
    /// What the sweep has to reach.
    sweep: [f64; 2],
}

const CAPTURES: [Capture; 2] = [
    Capture {
        name: "balancing",
        folder: "balancing_person",
        frame: 50,
        bounds: BALANCING,
        psnr: 14.1,
        ssim: 0.457,
        iou: 0.93,
        sweep: [13.7, 0.42],
    },
    // The silhouettes hold a shadow on the floor, which the hull puts below it.
    Capture {
        name: "seated",
        folder: "seated_person",
        frame: 0,
        bounds: Aabb { min: Point3::new(-0.5, -0.5, -0.2), ..SEATED },
        psnr: 18.7,
        ssim: 0.53,
        iou: 0.985,
        sweep: [17.9, 0.48],
    },
];

/// What of the scene is left out in the place of a camera.
#[derive(Clone, Copy)]
enum LeftOut {
    Nothing,
    Colours,
    /// Colours and silhouette.
    View,
}

/// Measures the captures that are there.
pub fn measure() -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let (mut own, mut holes) = (Vec::new(), 0);
    for capture in &CAPTURES {
        let Some(dir) = captures::find(capture.folder) else { continue };
        eprintln!("view: {}", capture.name);
        let volume = VolumeOptions { bounds: Some(capture.bounds), ..VolumeOptions::default() };
        let scene = CapturedFrames::open(&dir, &volume)?.scene(capture.frame)?;
        let blend = compared(&scene, Method::Blend, LeftOut::Colours)?;
        let sweep = Comparison::mean(&compared(&scene, Method::Sweep, LeftOut::Colours)?);
        let shape = Comparison::mean(&compared(&scene, Method::Hull, LeftOut::Colours)?);
        let strict = Comparison::mean(&compared(&scene, Method::Blend, LeftOut::View)?);
        own.extend(compared(&scene, Method::Blend, LeftOut::Nothing)?);

        let blend = Comparison::mean(&blend);
        holes += blend.holes;
        let named = |what: &str| format!("view_{}_{what}", capture.name);
        let bounded = |what: &str, value, bound: Bound| Figure::bounded(&named(what), value, bound);
        let reported = |what: &str, value| Figure::reported(&named(what), value);
        figures.extend([
            bounded("psnr", blend.psnr, AtLeast(capture.psnr)),
            bounded("ssim", blend.ssim, AtLeast(capture.ssim)),
            bounded("iou", blend.iou, AtLeast(capture.iou)),
            bounded("psnr_over_sweep", blend.psnr - sweep.psnr, AtLeast(0.0)),
            bounded("ssim_over_sweep", blend.ssim - sweep.ssim, AtLeast(0.0)),
            bounded("psnr_over_hull", blend.psnr - shape.psnr, AtLeast(0.0)),
            bounded("ssim_over_hull", blend.ssim - shape.ssim, AtLeast(0.0)),
            bounded("sweep_psnr", sweep.psnr, AtLeast(capture.sweep[0])),
            bounded("sweep_ssim", sweep.ssim, AtLeast(capture.sweep[1])),
            reported("psnr_hull", shape.psnr),
            reported("ssim_hull", shape.ssim),
            reported("psnr_of_both", blend.psnr_of_both),
            reported("psnr_strict", strict.psnr),
            reported("ssim_strict", strict.ssim),
            reported("iou_strict", strict.iou),
        ]);
    }
    if own.is_empty() {
        return Ok(figures);
    }
    // Equal pixels have no error; they count as 99 dB, one level in one of 500 values.
    let decibels = own.iter().map(|one: &Comparison| one.psnr.min(99.0));
    let mean = decibels.clone().sum::<f64>() / own.len() as f64;
    figures.extend([
        Figure::bounded("view_self_psnr_mean", mean, AtLeast(42.0)),
        Figure::bounded("view_self_psnr_worst", decibels.fold(f64::INFINITY, f64::min), AtLeast(38.0)),
        Figure::bounded("view_holes", holes as f64, Bound::AtMost(0.0)),
    ]);
    Ok(figures)
}

/// A comparison for each camera.
fn compared(scene: &Scene, method: Method, left_out: LeftOut) -> Result<Vec<Comparison>> {
    let kind = if method == Method::Sweep { RendererKind::Gpu } else { RendererKind::Cpu };
    let mut renderer = Renderer::open(kind, method)?;
    let options =
        DrawOptions { method, snap: false, shadows: false, surroundings: false, ..DrawOptions::default() };
    let mut found = Vec::new();
    for (view, camera) in scene.views.iter().enumerate() {
        let Some(truth) = Truth::of(camera) else { continue };
        let scene = match left_out {
            LeftOut::Nothing => scene.clone(),
            LeftOut::Colours => scene.without_colours_of(view),
            LeftOut::View => scene.without_view(view),
        };
        found.push(truth.compare(&renderer.draw(&scene, camera.camera(), &options)?));
    }
    Ok(found)
}
