//! Stages.
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_testing::rendered::Rendered;
use ode_visual_hull_viewer::cpu::CpuRenderer;
use ode_visual_hull_viewer::gpu::{Device, GpuRenderer};
use ode_visual_hull_viewer::orbit::Orbit;
use ode_visual_hull_viewer::scene::RealCameras;
use ode_visual_hull_viewer::*;
use std::time::Instant;
fn main() {
    let r = Rendered::new(Subject::person_at(0.4), 8, (640, 480)).unwrap();
    let cameras = RealCameras::new(&r.cameras);
    let images: Vec<_> = r.images.iter().cloned().map(Some).collect();
    let device = Device::new().unwrap();
    let mut gpu = GpuRenderer::new(&device);
    for round in 0..6 {
        let t = Instant::now();
        let scene = cameras.scene(&r.hull, images.clone()).unwrap();
        print!("scene {:.1} ", t.elapsed().as_secs_f64() * 1e3);
        let camera = Orbit::around(scene.hull.aabb(), 0.5 * round as f64).camera((640, 480)).unwrap();
        let plain = DrawOptions { refine: false, shadows: false, surroundings: false, ..Default::default() };
        let cpu = CpuRenderer::new(&scene);
        let mut last = 0.0;
        for (name, o) in [
            ("hull", DrawOptions { method: Method::Hull, ..plain }),
            ("hull again", DrawOptions { method: Method::Hull, ..plain }),
            ("blend", plain), ("blend again", plain),
            ("refine", DrawOptions { refine: true, ..plain }),
            ("floor", DrawOptions { surroundings: true, ..plain }),
            ("shadows", DrawOptions { surroundings: true, shadows: true, ..plain }),
            ("shadows again", DrawOptions { surroundings: true, shadows: true, ..plain }),
        ] {
            let t = Instant::now();
            cpu.draw(&camera, &o);
            last = t.elapsed().as_secs_f64() * 1e3;
            print!("{name} {last:.1} ");
        }
        let t = Instant::now();
        gpu.set_scene(&scene).unwrap();
        print!("gpu set {:.1} ", t.elapsed().as_secs_f64() * 1e3);
        let t = Instant::now();
        let p = gpu.draw(&camera, &plain).unwrap();
        print!("gpu draw {:.1} ", t.elapsed().as_secs_f64() * 1e3);
        let t = Instant::now();
        let p = gpu.draw(&camera, &DrawOptions { refine: true, ..plain }).unwrap();
        print!("gpu refine {:.1} ", t.elapsed().as_secs_f64() * 1e3);
        println!();
        let _ = (last, p);
    }
}
