//! Measures the quality of drawn pictures.
use ode_visual_hull::hull::{Hull, HullData};
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::recording::Recording;
use ode_visual_hull_viewer::cpu::CpuRenderer;
use ode_visual_hull_viewer::metrics::*;
use ode_visual_hull_viewer::scene::RealCameras;
use ode_visual_hull_viewer::*;
use std::sync::Arc;

fn main() {
    for (name, frame) in [("balancing_person", 50), ("seated_person", 0)] {
        let dir = format!("../shared/data/{name}");
        let recording = Recording::open(&dir).unwrap();
        let data = HullData::new();
        data.add_views(recording.rig().cameras()).unwrap();
        let mut b = recording.rig().work_volume().unwrap(); println!("{b:?}"); b.min.z -= 0.2; data.set_bounds(b).unwrap();
        let hull: Arc<Hull> = publish_masks(&data, &recording.masks(frame).unwrap(), 0.0).unwrap();
        let images: Vec<_> = recording.images(frame).unwrap().into_iter().map(Some).collect();
        let cameras = RealCameras::new(recording.rig().cameras());
        let scene = cameras.scene(&hull, &images).unwrap();
        for (label, options, own) in [
            
            
            ("refine", DrawOptions::default(), false),
            
        ] {
            let mut all = vec![];
            for out in 0..scene.views.len() {
                let mut scene = scene.clone();
                if !own {
                    scene.views[out].leave_out_colours();
                }
                let start = std::time::Instant::now();
                let renderer = CpuRenderer::new(&scene);
                let prepared = start.elapsed().as_secs_f64();
                let start = std::time::Instant::now();
                let picture = renderer.draw(scene.views[out].camera(), &DrawOptions { surroundings: false, shadows: false, snap: false, ..options });
                let took = start.elapsed().as_secs_f64();
                let silhouette = hull.views()[out].silhouette();
                let (w, h) = scene.views[out].camera().size();
                let real: Vec<bool> = (0..h)
                    .flat_map(|y| (0..w).map(move |x| (x, y)))
                    .map(|(x, y)| silhouette.is_subject(x as i32, y as i32))
                    .collect();
                let drawn: Vec<bool> = picture.content.iter().map(|c| *c == Content::Subject).collect();
                let both: Vec<bool> = real.iter().zip(&drawn).map(|(a, b)| *a || *b).collect();
                let mut truth = scene.views[out].photo().unwrap().clone();
                for (pixel, real) in truth.pixels_mut().zip(&real) {
                    if !real {
                        pixel.0 = [0; 3];
                    }
                }
                let p = psnr(&picture.colour, &truth, &both);
                let full = scene.views[out].photo().unwrap();
                let drawn_psnr = psnr(&picture.colour, full, &drawn);
                let unmasked = psnr(&picture.colour, full, &both);
                all.push([
                    p,
                    psnr(&picture.colour, &truth, &real),
                    structural_similarity(&picture.colour, &truth, &both),
                    structural_similarity(&picture.colour, full, &both),
                    intersection_over_union(&real, &drawn),
                    unmasked,
                    drawn_psnr,
                    prepared * 1e3,
                    took * 1e3,
                ]);
                let dir = "target/view";
                std::fs::create_dir_all(dir).unwrap();
                picture.colour.save(format!("{dir}/{name}_{label}_{out}.png")).unwrap();
                truth.save(format!("{dir}/{name}_truth_{out}.png")).unwrap();
            }
            let mean: Vec<String> = (0..9)
                .map(|k| format!("{:.3}", all.iter().map(|a| a[k]).sum::<f64>() / all.len() as f64))
                .collect();
            println!(
                "{name} {label}: psnr {} real {} ssim {} / {} iou {} unmasked {} drawn {} prep {} ms draw {} ms   worst {:.2}",
                mean[0],
                mean[1],
                mean[2],
                mean[3],
                mean[4],
                mean[5],
                mean[6],
                mean[7],
                mean[8],
                all.iter().map(|a| a[0]).fold(f64::INFINITY, f64::min)
            );
        }
    }
}
