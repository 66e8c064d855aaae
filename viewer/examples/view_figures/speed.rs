//! The time of a picture, from the scene to its pixels, with eight cameras of 640 x 480 pixels.

use nalgebra::Isometry3;
use ode_visual_hull::Result;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_film::Drawn;
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::median;
use ode_visual_hull_testing::rendered::Rendered;
use ode_visual_hull_viewer::orbit::Orbit;
use ode_visual_hull_viewer::scene::{RealCameras, Scene};
use ode_visual_hull_viewer::{DrawOptions, Method, Renderer, RendererKind};
use std::time::Instant;

const VGA: (u32, u32) = (640, 480);

/// Rounds in which all candidates take turns, and those at the start that are not counted.
const ROUNDS: usize = 12;
const WARM_UP: usize = 2;

/// A picture that is timed.
struct Candidate {
    name: &'static str,
    kind: RendererKind,
    size: (u32, u32),
    options: DrawOptions,
}

/// The candidates: the refined picture is the default one. The sweep is the published one, which ends at a pixel's first
/// consistent plane; the culled sweep begins at the hull as well.
fn candidates() -> Vec<Candidate> {
    let refined = DrawOptions::default();
    let plain = DrawOptions { refine: false, ..refined };
    let sweep = DrawOptions { method: Method::Sweep, ..refined };
    let subject = DrawOptions { shadows: false, surroundings: false, ..plain };
    let candidate = |name, kind, size, options| Candidate { name, kind, size, options };
    vec![
        candidate("frame_ms", RendererKind::Gpu, VGA, refined),
        candidate("frame_plain_ms", RendererKind::Gpu, VGA, plain),
        candidate("frame_720p_ms", RendererKind::Gpu, (1280, 720), refined),
        candidate("sweep_ms", RendererKind::Gpu, VGA, DrawOptions { cull_planes: false, ..sweep }),
        candidate("culled_sweep_ms", RendererKind::Gpu, VGA, sweep),
        candidate("subject_ms", RendererKind::Gpu, VGA, subject),
        candidate("cpu_subject_ms", RendererKind::Cpu, VGA, subject),
        candidate("cpu_frame_ms", RendererKind::Cpu, VGA, refined),
        candidate("cpu_frame_plain_ms", RendererKind::Cpu, VGA, plain),
        candidate("cpu_frame_720p_ms", RendererKind::Cpu, (1280, 720), refined),
    ]
}

/// Times all candidates in turns.
pub fn measure() -> Result<Vec<Figure>> {
    eprintln!("view: speed");
    let rendered = Rendered::new(Subject::person_at(0.4), 8, VGA)?;
    let cameras = RealCameras::new(&rendered.cameras);
    let candidates = candidates();
    let mut renderers = [Renderer::open(RendererKind::Gpu, Method::Blend)?, Renderer::Cpu];
    eprintln!("view: {}", renderers[0].description());

    let mut times = vec![Vec::new(); candidates.len()];
    let mut prepared = Vec::new();
    for round in 0..ROUNDS {
        let images: Vec<_> = rendered.images.iter().cloned().map(Some).collect();
        let started = Instant::now();
        let mut scene = cameras.scene(&rendered.hull, images)?;
        let preparation = milliseconds(started);
        add_bodies(&mut scene);
        let orbit = Orbit::around(scene.hull.aabb(), 0.5 * round as f64);
        for (candidate, times) in candidates.iter().zip(&mut times) {
            let renderer = &mut renderers[usize::from(candidate.kind == RendererKind::Cpu)];
            let viewpoint = orbit.camera(candidate.size)?;
            let started = Instant::now();
            renderer.draw(&scene, &viewpoint, &candidate.options)?;
            if round >= WARM_UP {
                times.push(preparation + milliseconds(started));
            }
        }
        if round >= WARM_UP {
            prepared.push(preparation);
        }
    }

    let medians: Vec<f64> = times.into_iter().map(median).collect();
    let of = |name: &str| {
        let found = candidates.iter().position(|candidate| candidate.name == name);
        found.map_or(f64::NAN, |index| medians[index])
    };
    let mut figures = vec![
        Figure::bounded("view_frame_over_sweep", of("frame_ms") / of("sweep_ms"), Bound::AtMost(0.25)),
        Figure::bounded("view_720p_over_vga", of("frame_720p_ms") / of("frame_ms"), Bound::AtMost(2.3)),
        Figure::reported("view_frame_over_culled_sweep", of("frame_ms") / of("culled_sweep_ms")),
        // Either renderer may be used where there is no GPU.
        Figure::bounded("view_frame_ms", of("frame_ms").min(of("cpu_frame_ms")), Bound::AtMost(100.0)),
        Figure::bounded(
            "view_frame_plain_ms",
            of("frame_plain_ms").min(of("cpu_frame_plain_ms")),
            Bound::AtMost(50.0),
        ),
        Figure::reported("view_scene_ms", median(prepared)),
    ];
    figures.extend(candidates.iter().zip(&medians).map(|(candidate, time)| {
        let device = if candidate.kind == RendererKind::Cpu { "" } else { "gpu_" };
        Figure::reported(&format!("view_{device}{}", candidate.name), *time)
    }));
    Ok(figures)
}

/// Puts a stack of boxes beside the subject.
fn add_bodies(scene: &mut Scene) {
    let stacked = |k: u32| Drawn {
        shape: Shape::cube(0.2),
        world_from_body: Isometry3::translation(0.6, 0.2, 0.1 + 0.2 * f64::from(k)),
        colour: [222, 86, 62],
    };
    scene.bodies = (0..5).map(stacked).collect();
}

fn milliseconds(since: Instant) -> f64 {
    1e3 * since.elapsed().as_secs_f64()
}
