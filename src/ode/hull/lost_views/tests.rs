//! Boxes beside a table, one of whose sides only one view bounds, while that view is lost.

use crate::hull::{Aabb, HullData};
use crate::ode::{Amount, BodyId, ContactGeom, GeomId, Mass, Ode, Shape, Surface, World};
use crate::synthetic::{Placed, Solid, Subject, Texture, layout, silhouette};
use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3, point, vector};
use std::sync::Arc;

/// Half the table's side lengths, in metres.
const HALF: f64 = 0.2;

/// Side length of the boxes, in metres.
const SIDE: f64 = 0.1;

/// The view that alone shows that there is nothing beyond the table's side at y = [`HALF`].
const VIEW: usize = 0;

/// A world with the hull of a table.
struct Scene {
    world: World,
    hull: GeomId,
    data: Arc<HullData>,
    masks: Vec<GrayImage>,
    time: f64,
}

impl Scene {
    fn new() -> Self {
        let lengths = vector![2.0 * HALF, 2.0 * HALF, 2.0 * HALF];
        let solid = Solid::cuboid(lengths).unwrap();
        let table =
            Subject::new(vec![Placed::new(solid, Isometry3::identity(), Texture::plain([200, 0, 0]))]);
        let cameras = layout::face_on(lengths, &Isometry3::identity(), 2.8, 0.2, (320, 240), 0.4).unwrap();
        let masks = cameras.iter().map(|camera| silhouette(camera, &table)).collect();

        let data = HullData::new();
        data.add_views(&cameras).unwrap();
        data.set_bounds(Aabb::new(point![-0.6, -0.6, -0.3], point![0.6, 0.6, 0.5]).unwrap()).unwrap();
        let data = Arc::new(data);
        let mut world = World::new(&Ode::init().unwrap()).unwrap();
        let root = world.root_space();
        let hull = world.add_hull(root, &data).unwrap();
        let mut scene = Self { world, hull, data, masks, time: 0.0 };
        scene.show_table();
        scene
    }

    fn show_table(&mut self) {
        for (view, mask) in self.masks.iter().enumerate() {
            self.data.set_mask(view, mask).unwrap();
        }
        self.update();
    }

    fn update(&mut self) {
        self.time += 0.1;
        self.data.update(self.time).unwrap();
    }

    /// Disables or enables [`VIEW`], and publishes a frame.
    fn enable(&mut self, enabled: bool) {
        self.data.set_view_enabled(VIEW, enabled).unwrap();
        self.update();
    }

    /// Adds a box whose side is `gap` metres beyond the table's side, at a place along it.
    fn add_box(&mut self, x: f64, gap: f64) -> (BodyId, GeomId) {
        let shape = Shape::cube(SIDE);
        let (body, root) = (self.world.add_body(), self.world.root_space());
        let geom = self.world.add_geom(root, &shape).unwrap();
        self.world.geom_mut(geom).set_body(Some(body)).unwrap();
        self.world.body_mut(body).set_mass(&Mass::of(&shape, Amount::Total(1.0)).unwrap()).unwrap();
        let pose = Isometry3::translation(x, HALF + 0.5 * SIDE + gap, 0.0);
        self.world.body_mut(body).set_pose(&pose).unwrap();
        (body, geom)
    }

    fn contacts(&mut self, geom: GeomId) -> Vec<ContactGeom> {
        self.world.collide_geoms(self.hull, geom, 8).unwrap()
    }

    fn deepest(&mut self, geom: GeomId) -> f64 {
        self.contacts(geom).iter().map(|contact| contact.depth).fold(0.0, f64::max)
    }

    fn step(&mut self, count: usize) {
        for _ in 0..count {
            self.world.default_collide(&Surface::with_friction(0.8), 8).unwrap();
            self.world.step(0.005).unwrap();
        }
    }
}

/// Less than the hull grows at x = 0.1 m, by about 4 cm, as the opposite view sees the table's corner; far more than any
/// depth before the loss.
const DEEP: f64 = 0.02;

#[test]
fn a_body_that_was_there_keeps_its_contacts_and_one_that_comes_later_is_deep_inside() {
    let mut scene = Scene::new();
    let (_, near) = scene.add_box(-0.1, -0.005);
    let (_, far) = scene.add_box(0.1, 0.005);
    let before = scene.contacts(near);
    assert!(!before.is_empty() && scene.deepest(far) == 0.0);

    scene.enable(false);
    for _ in 0..3 {
        assert_eq!(scene.contacts(near), before);
        assert_eq!(scene.deepest(far), 0.0);
        scene.update();
    }
    let (_, later) = scene.add_box(0.1, 0.005);
    assert!(scene.deepest(later) > DEEP);

    scene.enable(true);
    assert_eq!(scene.contacts(near), before);
    assert_eq!([scene.deepest(far), scene.deepest(later)], [0.0; 2]);
}

#[test]
fn a_view_that_is_late_is_lost_as_one_that_is_disabled() {
    let mut scene = Scene::new();
    scene.data.set_max_age(Some(0.15)).unwrap();
    let (_, near) = scene.add_box(-0.1, -0.005);
    let before = scene.contacts(near);
    for _ in 0..3 {
        for (view, mask) in scene.masks.iter().enumerate().filter(|(view, _)| *view != VIEW) {
            scene.data.set_mask(view, mask).unwrap();
        }
        scene.update();
        assert_eq!(scene.contacts(near), before);
    }
    let (_, later) = scene.add_box(0.1, 0.005);
    assert!(scene.deepest(later) > DEEP);
}

#[test]
fn a_body_that_the_grown_hull_has_left_is_inside_when_it_comes_back() {
    let mut scene = Scene::new();
    let (_, there) = scene.add_box(0.1, 0.005);
    scene.contacts(there);
    scene.enable(false);
    assert_eq!(scene.deepest(there), 0.0);

    // The other views show that the subject has left.
    let empty = GrayImage::new(320, 240);
    (0..scene.masks.len()).for_each(|view| scene.data.set_mask(view, &empty).unwrap());
    scene.update();
    assert_eq!(scene.deepest(there), 0.0);
    scene.show_table();
    assert!(scene.deepest(there) > DEEP);
}

#[test]
fn views_that_never_took_part_and_those_of_other_data_are_not_lost() {
    let mut scene = Scene::new();
    let (_, geom) = scene.add_box(0.1, 0.005);
    assert_eq!(scene.deepest(geom), 0.0);

    let other = Scene::new().data;
    other.set_view_enabled(VIEW, false).unwrap();
    other.update(1.0).unwrap();
    scene.world.hull_mut(scene.hull).set_data(&other);
    assert!(scene.deepest(geom) > DEEP);
}

/// The places of a box that may not sleep and of one that sleeps, after a second in which a view is lost or not.
fn places_after_a_second(is_lost: bool) -> [Point3<f64>; 2] {
    let mut scene = Scene::new();
    scene.world.set_gravity(&vector![0.0, 0.0, -9.81]).unwrap();
    let floor = Shape::Plane { normal: Vector3::z(), offset: -0.5 * SIDE };
    let root = scene.world.root_space();
    scene.world.add_geom(root, &floor).unwrap();
    let boxes = [-0.1, 0.1].map(|x| scene.add_box(x, -0.0005).0);
    scene.world.body_mut(boxes[1]).set_auto_disable(true);
    scene.step(200);

    for enabled in [!is_lost, true] {
        scene.enable(enabled);
        scene.step(100);
        assert!(!scene.world.body(boxes[1]).is_enabled());
    }
    boxes.map(|body| scene.world.body(body).position())
}

#[test]
fn boxes_that_rest_or_sleep_do_so_to_the_bit_when_a_view_is_lost_and_comes_back() {
    assert_eq!(places_after_a_second(true), places_after_a_second(false));
}
