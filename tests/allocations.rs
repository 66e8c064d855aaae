//! A running program does not allocate, once all buffers have grown to their final size.

use nalgebra::{Isometry3, Point3, Vector3, point};
use ode_visual_hull::camera::{Camera, Distortion};
use ode_visual_hull::contact::{self, SampledBody, Settings};
use ode_visual_hull::hull::{Aabb, Hull, HullData, Points, Workspace};
use ode_visual_hull::sample;
use ode_visual_hull::synthetic::{Subject, layout, silhouette};
use std::sync::LazyLock;

/// Seven VGA cameras without distortion.
fn pinholes() -> Vec<Camera> {
    let target = point![0.0, 0.0, 0.95];
    layout::staggered(7, 3.2, &[0.2, 1.6, 0.8, 2.3], target, (640, 480), 1.1).unwrap()
}

/// Masks of a walking person at three times in the pinhole cameras.
static MOMENTS: LazyLock<Vec<Vec<image::GrayImage>>> = LazyLock::new(|| {
    let masks = |time: f64| {
        let person = Subject::person_at(time);
        pinholes().iter().map(|camera| silhouette(camera, &person)).collect()
    };
    [0.0, 0.2, 0.4].map(masks).into()
});

/// Cameras around a walking person, with or without lenses. Masks are always those of the pinhole cameras: allocation
/// depends only on their size and shape.
struct Studio {
    data: HullData,
}

impl Studio {
    fn new(distortion: Distortion) -> Self {
        let with_lens = |camera: &Camera| {
            let (intrinsics, pose) = (*camera.intrinsics(), *camera.cam_from_world());
            Camera::new(camera.name(), camera.size(), intrinsics, distortion, pose).unwrap()
        };
        let cameras: Vec<_> = pinholes().iter().map(with_lens).collect();

        let data = HullData::new();
        for camera in &cameras {
            data.add_view(camera.clone()).unwrap();
        }
        data.set_bounds(Aabb::new(point![-1.0, -1.0, -0.1], point![1.0, 1.0, 2.0]).unwrap()).unwrap();
        Self { data }
    }

    fn show(&self, frame: usize) -> std::sync::Arc<Hull> {
        for (view, mask) in MOMENTS[frame % MOMENTS.len()].iter().enumerate() {
            self.data.set_mask(view, mask).unwrap();
        }
        self.data.update(frame as f64 / 30.0).unwrap()
    }
}

#[test]
fn frames_and_batches_allocate_nothing_in_the_steady_state() {
    let studio = Studio::new(Distortion::none());
    let samples = sample::box_(Vector3::new(0.1, 0.2, 0.25), 0.03).unwrap();
    let cloud: Vec<Point3<f64>> = samples.points().iter().map(|sample| sample.point).collect();
    let points = Points::new(&cloud);

    let (mut workspace, mut contacts, mut responses) = (Workspace::new(), Vec::new(), Vec::new());
    let pose = |k: usize| Isometry3::translation(0.0, 0.1 * (k % 4) as f64 - 0.2, 0.3 * (k % 6) as f64);
    let body = |k| SampledBody { samples: &samples, hull_from_body: pose(k), last_escape: None };
    let bodies: Vec<_> = (0..24).map(body).collect();
    let placed: Vec<Vec<Point3<f64>>> =
        (0..6).map(|k| cloud.iter().map(|point| pose(k) * point).collect()).collect();

    let mut colliding = 0;
    let mut run = |frame: usize| {
        let hull = studio.show(frame);
        for (k, placed) in placed.iter().enumerate() {
            colliding += hull.inside_many(&points, &pose(k), &mut workspace).unwrap().count();
            colliding += hull.respond_many(placed, &mut workspace).len();
        }
        contact::collide_many(&hull, &bodies, &Settings::default(), &mut contacts);
        contact::body_responses(&hull, &bodies, &mut responses);
    };

    // The ring of past frames fills up, and each buffer grows to the largest silhouette.
    (0..150).for_each(&mut run);
    let allocated = allocation_counter::measure(|| (150..210).for_each(&mut run));

    assert_eq!(allocated.count_total, 0);
    assert!(colliding > 1000);
}

#[test]
fn masks_of_lenses_allocate_nothing_in_the_steady_state() {
    let studio = Studio::new(Distortion::from_opencv(&[-0.2, 0.0, 0.0, 0.0]).unwrap());
    let hulls = |frames: std::ops::Range<usize>| frames.map(|frame| studio.show(frame)).for_each(drop);
    hulls(0..60);
    let allocated = allocation_counter::measure(|| hulls(60..90));
    assert_eq!(allocated.count_total, 0);
    assert!(studio.show(90).views().iter().all(|view| view.silhouette().has_coverage()));
}

#[test]
fn a_frame_takes_less_than_half_the_memory_of_its_masks() {
    let studio = Studio::new(Distortion::none());
    let hull = studio.show(0);
    let working: usize = hull.views().iter().map(|view| view.silhouette().working_memory()).sum();
    let masks: usize = MOMENTS[0].iter().map(|mask| mask.as_raw().len()).sum();
    assert!(2 * working < masks, "{working} of {masks}");
}

#[cfg(feature = "ode")]
#[test]
fn a_simulation_on_a_hull_allocates_nothing_in_the_steady_state() {
    use nalgebra::UnitQuaternion;
    use ode_visual_hull::ode::{Shape, SpaceKind};
    use ode_visual_hull_testing::{scene, world};

    let data = scene::table();
    let mut simulated = world::world(SpaceKind::default());
    let root = simulated.root_space();
    simulated.add_hull(root, &data).unwrap();
    let lying = scene::at(0.05, 0.1, scene::TOP + 0.041) * UnitQuaternion::from_euler_angles(1.57, 0.0, 0.3);
    let shapes = [
        (world::cube(0.15), scene::at(-0.12, -0.1, scene::TOP + 0.08)),
        (world::cube(0.1), scene::at(0.15, -0.12, scene::TOP + 0.06)),
        (Shape::Cylinder { radius: 0.04, length: 0.1 }, lying),
    ];

    let bodies = shapes.each_ref().map(|(shape, pose)| world::add_body(&mut simulated, shape, pose).0);

    let mut step = |k: usize| {
        scene::show_table(&data, 0.01 * k as f64);
        world::step(&mut simulated, 0.01);
        assert!(
            bodies.iter().all(|&body| world::height(&simulated, body) > scene::TOP),
            "all rest on the table"
        );
    };

    (1..100).for_each(&mut step);
    let allocated = allocation_counter::measure(|| (100..150).for_each(&mut step));

    assert_eq!(allocated.count_total, 0);
}
