//! Random safe calls around hulls: data shared between worlds on threads, panics in closures, worlds inside a collide.

use super::*;
use nalgebra::{Point3, Translation3};
use ode_visual_hull::contact::Mode;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{SpaceId, SpaceKind, SweepAxes};
use ode_visual_hull::sample;
use ode_visual_hull_random::Random;
use ode_visual_hull_testing::scene::{data_with, publish, table_cameras, table_masks};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Once};

/// What the worlds of all threads share.
struct Shared {
    data: Vec<Arc<HullData>>,
    clock: AtomicU64,
}

/// A world under random calls, and the ids of what is in it.
struct Scene<'a> {
    shared: &'a Shared,
    random: Random,
    world: World,
    spaces: Vec<SpaceId>,
    bodies: Vec<BodyId>,
    geoms: Vec<GeomId>,
    hulls: Vec<GeomId>,
}

fn pick<T: Copy>(random: &mut Random, list: &[T]) -> Option<T> {
    if list.is_empty() { None } else { Some(list[random.below(list.len())]) }
}

impl Shared {
    /// Shows the table in one of the data objects. Another thread may have published a later time already.
    fn show(&self, random: &mut Random) {
        let data = &self.data[random.below(self.data.len())];
        let time = self.clock.fetch_add(1, Ordering::Relaxed) as f64;
        table_masks().iter().enumerate().for_each(|(view, mask)| data.set_mask(view, mask).unwrap());
        let _ = data.update(time);
    }
}

impl<'a> Scene<'a> {
    fn new(shared: &'a Shared, seed: u64) -> Self {
        let mut random = Random(seed);
        let extents = Vector3::repeat(1.0);
        let kind = match random.below(4_u32) {
            0 => SpaceKind::Simple,
            1 => SpaceKind::default(),
            2 => SpaceKind::SweepAndPrune(SweepAxes::Zxy),
            _ => SpaceKind::QuadTree { center: Point3::origin(), extents, depth: 3 },
        };
        let mut world = World::with_space(&Ode::init().unwrap(), kind).unwrap();
        world.set_gravity(&Vector3::new(0.0, 0.0, -GRAVITY)).unwrap();
        world.set_auto_disable(true);
        let spaces = vec![world.root_space()];
        Self { shared, random, world, spaces, bodies: vec![], geoms: vec![], hulls: vec![] }
    }

    fn pose(&mut self) -> Isometry3<f64> {
        let at = Vector3::from_fn(|_, _| 0.8 * self.random.unit() - 0.4);
        Isometry3::from_parts(Translation3::from(at), self.random.rotation())
    }

    fn forget_removed(&mut self) {
        let Self { world, spaces, bodies, geoms, hulls, .. } = self;
        spaces.retain(|&space| world.contains_space(space));
        bodies.retain(|&body| world.contains_body(body));
        geoms.retain(|&geom| world.contains_geom(geom));
        hulls.retain(|&geom| world.contains_geom(geom));
    }

    /// Adds a hull, or a body with a geom.
    fn add(&mut self) {
        let space = pick(&mut self.random, &self.spaces).expect("the root stays");
        if self.random.below(4_u32) == 0 {
            let data = &self.shared.data[self.random.below(self.shared.data.len())];
            let hull = self.world.add_hull(space, data).unwrap();
            self.hulls.push(hull);
            self.geoms.push(hull);
            return;
        }
        let shape = match self.random.below(4_u32) {
            0 => Shape::Sphere { radius: 0.1 },
            1 => Shape::cuboid(0.1, 0.2, 0.1),
            2 => Shape::Ray { length: 1.0 },
            _ => Shape::Capsule { radius: 0.05, length: 0.1 },
        };
        let (body, geom) = (self.world.add_body(), self.world.add_geom(space, &shape).unwrap());
        self.world.geom_mut(geom).set_body(Some(body)).unwrap();
        let pose = self.pose();
        self.world.body_mut(body).set_pose(&pose).unwrap();
        self.bodies.push(body);
        self.geoms.push(geom);
    }

    fn remove(&mut self) {
        let Self { random, world, spaces, bodies, geoms, .. } = self;
        let _ = match random.below(4_u32) {
            0 => pick(random, geoms).map(|geom| world.remove_geom(geom)),
            1 => pick(random, bodies).map(|body| world.remove_body(body)),
            2 => pick(random, bodies).map(|body| world.remove_body_and_geoms(body)),
            // The root cannot be removed.
            _ => pick(random, spaces).map(|space| world.remove_space(space).is_ok()),
        };
        self.forget_removed();
    }

    fn change_hull(&mut self) {
        let Some(hull) = pick(&mut self.random, &self.hulls) else { return };
        let modes = [Mode::Clustered, Mode::Paper, Mode::Point, Mode::Single];
        let (mode, most) = (modes[self.random.below(4_usize)], self.random.below(20_usize));
        let mut view = self.world.hull_mut(hull);
        view.set_data(&self.shared.data[self.random.below(self.shared.data.len())]);
        view.set_mode(mode);
        let _ = (view.set_max_contacts(most), view.set_min_feature(0.02), view.view().take_error());

        let body = pick(&mut self.random, &self.bodies).filter(|_| most % 2 == 0);
        let pose = self.pose();
        self.world.geom_mut(hull).set_body(body).unwrap();
        let _ = (self.world.geom_mut(hull).set_offset(&pose), self.world.geom_mut(hull).set_pose(&pose));
    }

    fn change_geom(&mut self) {
        let Some(geom) = pick(&mut self.random, &self.geoms) else { return };
        let space = pick(&mut self.random, &self.spaces).expect("the root stays");
        if self.random.below(2_u32) == 0 {
            let points: Vec<_> = (0..20).map(|_| Point3::from(0.1 * self.random.direction())).collect();
            self.world.set_samples(geom, sample::from_points(&points, None).unwrap()).unwrap();
        } else {
            self.world.clear_samples(geom).unwrap();
        }
        let _ = self.world.geom_mut(geom).set_shape(&Shape::Sphere { radius: 0.05 });
        self.world.geom_mut(geom).set_enabled(self.random.below(4_u32) > 0);
        self.world.geom_mut(geom).set_space(space).unwrap();
    }

    fn query(&mut self) {
        let (a, b) = (pick(&mut self.random, &self.geoms), pick(&mut self.random, &self.geoms));
        let (Some(a), Some(b)) = (a, b) else { return };
        for contact in self.world.collide_geoms(a, b, 1 + self.random.below(40_usize)).unwrap() {
            assert!((contact.normal.norm() - 1.0).abs() < 1e-6 && contact.depth >= 0.0, "{contact:?}");
        }
        if let Ok(hull) = self.world.get_hull(a) {
            let _ = (hull.body_response(b), hull.inside(&Point3::new(f64::NAN, 0.0, 0.0)));
        }
    }

    /// A collide whose closure publishes frames, steps another world, and may panic.
    fn collide_and_more(&mut self) {
        let mut other = World::new(&Ode::init().unwrap()).unwrap();
        let root = other.root_space();
        other.add_hull(root, &self.shared.data[0]).unwrap();
        other.add_geom(root, &Shape::Sphere { radius: 0.3 }).unwrap();
        let panics = self.random.below(2_u32) == 0;
        let (random, shared) = (&mut self.random, self.shared);
        let collide = || {
            self.world.collide(|pair| {
                let held = pair.contacts(8);
                shared.show(random);
                other.collide(|inner| drop((inner.touches(), inner.contacts(8)))).unwrap();
                other.quick_step(0.001).unwrap();
                pair.contacts(500)
                    .iter()
                    .chain(held.iter())
                    .for_each(|c| pair.attach(c, &Surface::default()));
                assert!(!panics, "a panic of the closure");
            })
        };
        let _ = catch_unwind(AssertUnwindSafe(collide));
    }

    fn run(mut self) -> World {
        for _ in 0..50 {
            match self.random.below(12_u32) {
                0..=3 => self.add(),
                4 => self.remove(),
                5 => self.change_hull(),
                6 => self.change_geom(),
                7 => self.query(),
                8 => self.collide_and_more(),
                9 => {
                    let parent = pick(&mut self.random, &self.spaces).expect("the root stays");
                    self.spaces.push(self.world.add_space(parent, SpaceKind::Simple).unwrap());
                }
                10 => self.shared.show(&mut self.random),
                _ => drop(self.world.default_collide(&Surface::default(), 8)),
            }
            let _ = self.world.quick_step(0.005);
        }
        self.world
    }
}

/// Keeps the panics of closures out of the test's output.
fn silence_expected_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let print = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if !panic.to_string().contains("a panic of the closure") {
                print(panic);
            }
        }));
    });
}

#[test]
fn random_calls_on_several_threads_never_abort() {
    silence_expected_panics();
    for seed in 0..4_u64 {
        let data = (0..3).map(|_| data_with(&table_cameras())).collect();
        let shared = Shared { data, clock: AtomicU64::new(1) };
        publish(&shared.data[0], table_masks(), 0.5);
        let worlds: Vec<World> = std::thread::scope(|scope| {
            let run = |thread| Scene::new(&shared, 100 * seed + thread + 1).run();
            let threads: Vec<_> = (0..2_u64).map(|thread| scope.spawn(move || run(thread))).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        // Worlds and data are dropped in either order, the worlds on another thread.
        if seed % 2 == 0 {
            drop(shared);
        }
        std::thread::spawn(move || drop(worlds)).join().unwrap();
    }
}
