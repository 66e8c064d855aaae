//! The cost of calls of the C functions, compared with the same queries in Rust.

use crate::studio::{add_body, at, data, level_ring, masks, median, publish, table, world};
use nalgebra::{Point3, Vector3, point};
use ode_sys::{dCreateBox, dGeomDestroy, dGeomID, dGeomSetPosition, dSpaceID};
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::ode::{GeomId, Shape, World};
use ode_visual_hull::synthetic::coverage;
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use ode_visual_hull_testing::random::Random;
use std::ffi::{c_int, c_uchar, c_void};
use std::hint::black_box;
use std::ptr::null_mut;
use std::time::Instant;

type DataId = *mut c_void;

// Declarations of `include/ode_visual_hull.h`.
unsafe extern "C" {
    safe fn dInitVisualHull() -> c_int;
    safe fn dCloseVisualHull();
    safe fn dGeomVisualHullDataCreate() -> DataId;
    safe fn dGeomVisualHullDataDestroy(d: DataId);
    fn dGeomVisualHullDataAddView(d: DataId, p: *const f64, width: c_int, height: c_int) -> c_int;
    fn dGeomVisualHullDataSetBounds(d: DataId, aabb: *const f64) -> c_int;
    fn dGeomVisualHullDataSetMask(d: DataId, view: c_int, mask: *const c_uchar, stride: c_int) -> c_int;
    safe fn dGeomVisualHullDataUpdate(d: DataId, time: f64) -> c_int;
    fn dCreateVisualHull(space: dSpaceID, d: DataId) -> dGeomID;
    safe fn dGeomVisualHullPointInside(g: dGeomID, x: f64, y: f64, z: f64) -> c_int;
    fn dGeomVisualHullPointResponse(g: dGeomID, x: f64, y: f64, z: f64, w: *mut f64) -> c_int;
    fn dGeomVisualHullBodyResponse(g: dGeomID, body: dGeomID, v: *mut f64) -> c_int;
}

/// Interleaved rounds on each scene. The figures are medians over all rounds.
const ROUNDS: usize = 21;

/// Number of scenes, each in memory of its own, because the place of the data in memory matters more than the calls.
const SCENES: u64 = 8;

const POINTS: usize = 2000;
const BODIES: usize = 20;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("calls of the C functions");
    let scenes: Vec<Scene> = (0..SCENES).map(Scene::new).collect();
    let mut figures = Vec::new();
    let mut worst: f64 = 0.0;
    for (name, calls, c, rust) in [
        ("inside", POINTS, Scene::inside_in_c as fn(&Scene), Scene::inside_in_rust as fn(&Scene)),
        ("response", POINTS, Scene::response_in_c, Scene::response_in_rust),
        ("body", BODIES, Scene::body_in_c, Scene::body_in_rust),
    ] {
        let (c_ns, rust_ns, ratio) = compare(&scenes, calls, c, rust);
        worst = worst.max(ratio);
        figures.push(Figure::reported(&format!("capi_ns_per_call_{name}"), c_ns));
        figures.push(Figure::reported(&format!("rust_ns_per_call_{name}"), rust_ns));
        figures.push(Figure::reported(&format!("capi_ns_per_call_{name}_over_rust"), ratio));
    }

    figures.push(Figure::bounded("capi_ns_per_call_over_rust", worst, AtMost(1.05)));
    figures
}

/// Median nanoseconds of a call in C and in Rust, and the median of the rounds' ratios.
fn compare(scenes: &[Scene], calls: usize, c: fn(&Scene), rust: fn(&Scene)) -> (f64, f64, f64) {
    let ns = |run: fn(&Scene), scene: &Scene| {
        let start = Instant::now();
        run(scene);
        start.elapsed().as_nanos() as f64 / calls as f64
    };
    // C and Rust alternate in going first.
    let round = |k: usize| {
        let scene = &scenes[k / ROUNDS];
        if k.is_multiple_of(2) {
            let first = ns(c, scene);
            (first, ns(rust, scene))
        } else {
            let first = ns(rust, scene);
            (ns(c, scene), first)
        }
    };

    let rounds: Vec<(f64, f64)> = (0..scenes.len() * ROUNDS).map(round).collect();
    let median_of = |of: fn(&(f64, f64)) -> f64| median(rounds.iter().map(of));
    (median_of(|round| round.0), median_of(|round| round.1), median_of(|round| round.0 / round.1))
}

/// The table seen by seven cameras, as a hull in a world of Rust and as a hull of the C functions.
struct Scene {
    world: World,
    hull: GeomId,
    cube: GeomId,
    c_data: DataId,
    c_hull: dGeomID,
    c_cube: dGeomID,
    /// Points to query, about half of them inside.
    points: Vec<Point3<f64>>,
}

impl Scene {
    fn new(seed: u64) -> Self {
        let cameras = level_ring(0.2);
        let masks = masks(&cameras, &table(), coverage);
        let rust_data = data(&cameras);
        publish(&rust_data, &masks, 0.0);

        let mut world = world(0, 0.0);
        let root = world.root_space();
        let hull = world.add_hull(root, &rust_data).expect("room for the class");
        let sides = Vector3::repeat(0.2);
        let (_, cube) = add_body(&mut world, &Shape::Box { sides }, &at(0.03, 0.01, 0.25));
        world.collide(|_| ()).expect("nothing to fail at");

        assert_eq!(dInitVisualHull(), 1);

        let c_data = dGeomVisualHullDataCreate();
        let bounds = [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0];

        // SAFETY: the arrays have the sizes that the header asks for; the geoms are in no space.
        let (c_hull, c_cube) = unsafe {
            dGeomVisualHullDataSetBounds(c_data, bounds.as_ptr());
            for (view, (camera, mask)) in cameras.iter().zip(&masks).enumerate() {
                let rows = camera.projection_matrix().transpose();
                let (width, height) = camera.size();
                dGeomVisualHullDataAddView(c_data, rows.as_ptr(), width as c_int, height as c_int);
                let bytes = mask.as_raw().as_ptr();
                dGeomVisualHullDataSetMask(c_data, view as c_int, bytes, width as c_int);
            }
            assert_eq!(dGeomVisualHullDataUpdate(c_data, 0.0), 1);
            let cube = dCreateBox(null_mut(), sides.x, sides.y, sides.z);
            dGeomSetPosition(cube, 0.03, 0.01, 0.25);
            (dCreateVisualHull(null_mut(), c_data), cube)
        };

        let around = Aabb::new(point![-0.3, -0.3, -0.25], point![0.3, 0.3, 0.25]).expect("a box");
        let mut random = Random(seed);
        let points = (0..POINTS).map(|_| random.point(around.min, around.max)).collect();

        Self { world, hull, cube, c_data, c_hull, c_cube, points }
    }

    fn inside_in_c(&self) {
        for p in &self.points {
            black_box(dGeomVisualHullPointInside(self.c_hull, p.x, p.y, p.z));
        }
    }

    fn inside_in_rust(&self) {
        for p in &self.points {
            black_box(self.world.hull(self.hull).inside(p));
        }
    }

    fn response_in_c(&self) {
        for p in &self.points {
            let mut w = [0.0; 4];
            // SAFETY: the geom lives, and `w` is a vector of ODE's.
            black_box(unsafe { dGeomVisualHullPointResponse(self.c_hull, p.x, p.y, p.z, w.as_mut_ptr()) });
            black_box(w);
        }
    }

    fn response_in_rust(&self) {
        for p in &self.points {
            black_box(self.world.hull(self.hull).point_response(p));
        }
    }

    fn body_in_c(&self) {
        for _ in 0..BODIES {
            let mut v = [0.0; 4];
            // SAFETY: the geoms live, and `v` is a vector of ODE's.
            black_box(unsafe { dGeomVisualHullBodyResponse(self.c_hull, self.c_cube, v.as_mut_ptr()) });
            black_box(v);
        }
    }

    fn body_in_rust(&self) {
        for _ in 0..BODIES {
            black_box(self.world.hull(self.hull).body_response(self.cube).expect("a box has samples"));
        }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: the geoms are ours and in no space.
        unsafe {
            dGeomDestroy(self.c_cube);
            dGeomDestroy(self.c_hull);
        }
        dGeomVisualHullDataDestroy(self.c_data);
        dCloseVisualHull();
    }
}
