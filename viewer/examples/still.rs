//! Draws a still.
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::shape::Shape;
use ode_visual_hull_film::Drawn;
use ode_visual_hull_viewer::cpu::CpuRenderer;
use ode_visual_hull_viewer::scene::RealCameras;
use ode_visual_hull_viewer::*;
fn main() {
    let (name, frame) = ("balancing_person", 50);
    let recording = Recording::open(format!("../shared/data/{name}")).unwrap();
    let data = HullData::new();
    data.add_views(recording.rig().cameras()).unwrap();
    data.set_bounds(recording.rig().work_volume().unwrap()).unwrap();
    let hull = publish_masks(&data, &recording.masks(frame).unwrap(), 0.0).unwrap();
    let images: Vec<_> = recording.images(frame).unwrap().into_iter().map(Some).collect();
    let cameras = RealCameras::new(recording.rig().cameras());
    let mut scene = cameras.scene(&hull, &images).unwrap();
    let c = hull.aabb().centre();
    let low = |dx: f64, dy: f64, z: f64| Isometry3::new(Vector3::new(c.x + dx, c.y + dy, z), Vector3::new(0.0, 0.0, 0.4));
    let put = |shape, pose, colour| Drawn { shape, world_from_body: pose, colour };
    scene.bodies = vec![
        put(Shape::cube(0.3), low(0.6, 0.3, 0.15), [222, 86, 62]),
        put(Shape::Sphere { radius: 0.15 }, low(-0.5, 0.5, 0.15), [66, 118, 202]),
        put(Shape::Capsule { radius: 0.08, length: 0.3 }, low(0.0, -0.7, 0.4), [240, 188, 60]),
        put(Shape::Cylinder { radius: 0.12, length: 0.3 }, low(-0.5, -0.5, 0.15), [146, 92, 186]),
        put(Shape::cube(0.25), low(0.6, 0.3, 0.425), [236, 236, 228]),
    ];
    let start = std::time::Instant::now();
    let renderer = CpuRenderer::new(&scene);
    println!("prepared in {:?}", start.elapsed());
    for (k, (dx, dy, z)) in [(2.5, 1.0, 1.5), (-2.5, 0.5, 1.0), (0.3, -2.6, 2.2)].into_iter().enumerate() {
        let eye = Point3::new(c.x + dx, c.y + dy, z);
        let camera = Camera::look_at("eye", (640, 480), 0.9, eye, Point3::new(c.x, c.y, 0.8), Vector3::z()).unwrap();
        for method in [Method::Blend, Method::Hull] {
            for _ in 0..10 {
            let start = std::time::Instant::now();
            let picture = renderer.draw(&camera, &DrawOptions { method, ..Default::default() });
            println!("{k} {method:?} {:?}", start.elapsed());
            picture.colour.save(format!("target/view/still_{k}_{method:?}.png")).unwrap();
            }
        }
    }
    let camera = cameras.pinhole(0).clone();
    let picture = renderer.draw(&camera, &DrawOptions::default());
    picture.colour.save("target/view/still_snap.png").unwrap();
}
