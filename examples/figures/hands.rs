//! Boxes that two bare hands lift, carry, throw, catch and stack, by friction and the velocity of the hands alone.

#[path = "../shared/hand_script.rs"]
mod hand_script;
mod task;

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Isometry3, UnitQuaternion, Vector3, point};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData, Motion};
use ode_visual_hull::ode::{BodyId, GeomId, Shape, Surface, World};
use ode_visual_hull::synthetic::{coverage, layout};
use ode_visual_hull_testing::edge_noise::displace_edge;
use ode_visual_hull_testing::figure::{Bound::AtLeast, Figure};
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::world::add_body;
use std::collections::HashMap;
use std::sync::Arc;
use task::{BOX, STEP, TASKS, Task};

/// Frames a second.
const RATE: f64 = 30.0;

/// The attempts at a task, and how many of them have the same noise.
const ATTEMPTS: usize = 100;
const ATTEMPTS_A_FILM: usize = 10;

/// The poses of a box at all steps.
type Path = Vec<Isometry3<f64>>;

/// The masks of each frame, by view.
type Film = Vec<Vec<GrayImage>>;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut figures = Vec::new();
    for task in TASKS {
        progress(task.name);
        let film = film(&task);
        let paths = attempt(&task, &film, ATTEMPTS, 0);
        figures.extend(of_task(&task, &paths, "", 0, 0.9));

        if task.name == "lift" || task.name.starts_with("carry") {
            progress(&format!("{} with 1 px of noise", task.name));
            let seeds = 1..=(ATTEMPTS / ATTEMPTS_A_FILM) as u64;
            let paths: Vec<Path> = seeds
                .flat_map(|seed| attempt(&task, &with_noise(&film, seed), ATTEMPTS_A_FILM, seed))
                .collect();
            figures.extend(of_task(&task, &paths, "_noisy", 1, 0.8));
        }
    }
    figures
}

/// The number of successes, by the bound without noise (0) or with it (1), and how high the box is lifted over how high the
/// hands are, at least `lifted`.
fn of_task(task: &Task, paths: &[Path], suffix: &str, noise: usize, lifted: f64) -> Vec<Figure> {
    let (name, found) = (format!("hands_{}{suffix}", task.name), task.count_successes(paths) as f64);
    let mut figures = vec![match task.least {
        Some(least) => Figure::bounded(&name, found, AtLeast(least[noise])),
        None => Figure::reported(&name, found),
    }];
    if task.name == "lift" {
        let mean = paths.iter().map(|path| task.lifted(path)).sum::<f64>() / paths.len() as f64;
        figures.push(Figure::bounded(&format!("lift_over_hands{suffix}"), mean, AtLeast(lifted)));
    }
    figures
}

/// Eight cameras around, every other one at the height of the floor: 3 mm a pixel.
fn cameras() -> Vec<Camera> {
    layout::staggered(8, 3.0, &[0.1, 1.2], point![0.0, 0.1, 0.5], (640, 480), 0.6).expect("a ring")
}

fn film(task: &Task) -> Film {
    let (cameras, frames) = (cameras(), (task.end() * RATE) as usize + 2);
    (0..frames).map(|frame| masks(&cameras, &task.script.subject(frame as f64 / RATE), coverage)).collect()
}

/// The film with a pixel of noise at the edges of its masks.
fn with_noise(film: &Film, seed: u64) -> Film {
    let noisy = |frame: usize, masks: &Vec<GrayImage>| {
        let seed = |view: usize| seed << 32 | (frame << 8 | view) as u64;
        masks.iter().enumerate().map(|(view, mask)| displace_edge(mask, 1.0, seed(view))).collect()
    };
    film.iter().enumerate().map(|(frame, masks)| noisy(frame, masks)).collect()
}

/// The paths of the boxes of several attempts, which differ in where the box is at first and how it is turned. They happen
/// side by side in one world, where no box meets that of another attempt.
fn attempt(task: &Task, film: &Film, count: usize, seed: u64) -> Vec<Path> {
    let data = HullData::new();
    for camera in cameras() {
        data.add_view(camera).expect("names of their own");
    }
    let bounds = Aabb::new(point![-1.0, -1.0, -0.2], point![1.0, 1.0, 1.6]).expect("a volume");
    data.set_bounds(bounds).expect("a volume");
    let data = Arc::new(data);

    let mut world = world(seed, 0.001);
    world.set_erp(0.05).expect("in range");
    let root = world.root_space();
    world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 }).expect("a unit normal");
    let hull = world.add_hull(root, &data).expect("room for the class");
    world.hull_mut(hull).set_motion(Motion::Interpolated);

    let (mut random, mut attempt_of) = (Random(seed), HashMap::new());
    let mut boxes = Vec::new();
    for attempt in 0..count {
        let shift = task.spread.map(|spread| spread * random.between(-1.0, 1.0));
        let (body, geom) = add_box(&mut world, &(task.start + shift), random.between(-0.1, 0.1));
        boxes.push(body);
        attempt_of.insert(geom, attempt);
        attempt_of.extend(task.base.map(|base| (add_box(&mut world, &base, 0.0).1, attempt)));
    }

    let (mut paths, mut frame) = (vec![Path::new(); count], 0);
    for step in 0..(task.end() / STEP) as usize {
        let time = step as f64 * STEP;
        while frame as f64 / RATE <= time + 1e-9 {
            publish(&data, &film[frame], frame as f64 / RATE);
            frame += 1;
        }
        for (&body, path) in boxes.iter().zip(&mut paths) {
            path.push(world.body(body).pose());
            world.body_mut(body).set_gravity(time >= task.let_go);
        }
        world.hull_mut(hull).set_time(time).expect("times that grow");
        collide(&mut world, &attempt_of);
        world.quick_step(STEP).expect("finite states");
    }
    paths
}

/// Adds a box of 1 kg, turned about the vertical.
fn add_box(world: &mut World, place: &Vector3<f64>, yaw: f64) -> (BodyId, GeomId) {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
    add_body(world, &Shape::Box { sides: BOX.into() }, &(at(place.x, place.y, place.z) * turn))
}

/// Attaches contacts with a coefficient of friction of 1, but for boxes of two attempts.
fn collide(world: &mut World, attempt_of: &HashMap<GeomId, usize>) {
    let surface = Surface::with_friction(1.0);
    let found = world.collide(|pair| {
        let [first, second] = pair.geoms().map(|geom| attempt_of.get(&geom));
        if first.is_some() && second.is_some() && first != second {
            return;
        }
        for contact in pair.contacts(8).iter() {
            pair.attach(contact, &pair.surface_at(contact, &surface, STEP));
        }
    });
    found.expect("valid contacts");
}
