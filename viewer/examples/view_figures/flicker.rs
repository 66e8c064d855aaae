//! How much pictures of a subject that stands still change with the noise of the images.

use ode_visual_hull::Result;
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::rendered::Rendered;
use ode_visual_hull_viewer::history::History;
use ode_visual_hull_viewer::metrics::mean_change;
use ode_visual_hull_viewer::orbit::Orbit;
use ode_visual_hull_viewer::scene::RealCameras;
use ode_visual_hull_viewer::{Content, DrawOptions, Method, Picture, Renderer, RendererKind};

/// Noise of the images in grey levels, the number of frames, and those at the start that are not counted.
const NOISE: f64 = 3.0;
const FRAMES: u64 = 12;
const SETTLED: usize = 4;

/// The mean change of a pixel that shows the subject in two frames one after the other, with and without what the last frame
/// showed.
pub fn measure() -> Result<Vec<Figure>> {
    eprintln!("view: flicker");
    let rendered = Rendered::new(Subject::person_at(0.4), 8, (640, 480))?;
    let cameras = RealCameras::new(&rendered.cameras);
    let viewpoint = Orbit::around(rendered.hull.aabb(), 0.7).camera((640, 480))?;
    let mut renderer = Renderer::open(RendererKind::Cpu, Method::Blend)?;
    let mut history = History::default();
    let (mut steadied, mut alone) = (Vec::new(), Vec::new());
    for frame in 0..FRAMES {
        let (images, hull) = rendered.exposed(NOISE, frame)?;
        let images: Vec<_> = images.into_iter().map(Some).collect();
        let scene = cameras.scene(&hull, images)?;
        let mut picture = renderer.draw(&scene, &viewpoint, &DrawOptions::default())?;
        alone.push(picture.clone());
        history.steady(&mut picture, &viewpoint);
        steadied.push(picture);
    }
    Ok(vec![
        Figure::bounded("view_flicker_levels", flicker(&steadied), Bound::AtMost(1.5)),
        Figure::reported("view_flicker_levels_without_history", flicker(&alone)),
    ])
}

/// The mean change from picture to picture of pixels that show the subject in both, in grey levels.
fn flicker(pictures: &[Picture]) -> f64 {
    let changes: Vec<f64> = pictures[SETTLED..]
        .windows(2)
        .map(|pair| {
            let is_subject = |k: usize| pair.iter().all(|picture| picture.content[k] == Content::Subject);
            let mask: Vec<bool> = (0..pair[0].content.len()).map(is_subject).collect();
            mean_change(&pair[0].colour, &pair[1].colour, &mask)
        })
        .collect();
    changes.iter().sum::<f64>() / changes.len() as f64
}
