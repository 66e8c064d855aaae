//! The collider returns the contacts that each body has alone, whatever was prefetched.

use super::super::{body_samples, class};
use super::*;
use crate::hull::{Aabb, HullData};
use crate::ode::convert;
use crate::ode::{BodyId, Convex, GeomId, Ode, Shape, SpaceId, SpaceKind, SweepAxes, TriMesh, World};
use crate::synthetic::{Subject, layout, silhouette};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, point, vector};
use ode_sys::{dAllocateMaskAll, dAllocateODEDataForThread, dCollide, dContactGeom};
use std::sync::Arc;

/// Boxes, balls and others that fly about a walking person, each on a course of its own.
struct Flight {
    world: World,
    data: Arc<HullData>,
    hull: GeomId,
    flyers: Vec<(BodyId, GeomId)>,
}

impl Flight {
    /// With the hull in the world's own space, and the bodies in `kind`.
    fn new(kind: Option<SpaceKind>) -> Self {
        let cameras =
            layout::staggered(5, 3.2, &[0.3, 1.5, 0.8], point![0.0, 0.0, 0.95], (320, 240), 1.1).unwrap();
        let data = Arc::new(HullData::new());
        data.add_views(&cameras).unwrap();
        data.set_bounds(Aabb::new(point![-1.0, -1.0, -0.1], point![1.0, 1.0, 2.0]).unwrap()).unwrap();
        let mut world = World::new(&Ode::init().unwrap()).unwrap();
        let root = world.root_space();
        let hull = world.add_hull(root, &data).unwrap();
        let space = kind.map_or(root, |kind| world.add_space(root, kind).unwrap());
        let mut flight = Self { world, data, hull, flyers: Vec::new() };
        shapes().iter().cycle().take(18).for_each(|shape| flight.add(space, shape));
        flight
    }

    fn add(&mut self, space: SpaceId, shape: &Shape) {
        let (body, geom) = (self.world.add_body(), self.world.add_geom(space, shape).unwrap());
        self.world.geom_mut(geom).set_body(Some(body)).unwrap();
        self.flyers.push((body, geom));
    }

    fn show(&self, step: usize) {
        let person = Subject::person_at(0.1 * (step % 3) as f64);
        for view in 0..self.data.view_count() {
            let camera = self.data.camera(view).unwrap();
            self.data.set_mask(view, &silhouette(&camera, &person)).unwrap();
        }
        self.data.update(step as f64 / 30.0).unwrap();
    }

    /// Moves each body along its course.
    fn fly(&mut self, step: usize) {
        for (k, &(body, _)) in self.flyers.iter().enumerate() {
            let t = 0.9 * k as f64 + 0.05 * step as f64;
            let at = Translation3::new(0.16 * t.cos(), 0.2 * (1.7 * t).sin(), 0.3 + 0.075 * k as f64);
            let pose = Isometry3::from_parts(at, UnitQuaternion::from_euler_angles(t, 0.4 * t, 0.3));
            self.world.body_mut(body).set_pose(&pose).unwrap();
        }
    }

    /// Collides, and compares each body's contacts with those that it has alone. Returns how many bodies touched, and how
    /// many contacts came from the prefetch.
    fn collide(&mut self) -> (usize, usize) {
        let (hull, mut touching, mut queried) = (self.hull, 0, 0);
        self.world
            .collide(|pair| {
                let Some(other) = pair.geoms().into_iter().find(|&geom| geom != hull) else { return };
                if pair.geoms().contains(&hull) {
                    // SAFETY: ODE shows living geoms, and both are used here alone.
                    let expected = unsafe {
                        let raw = pair.geom_views().map(|view| (view.id(), view.raw()));
                        let find = |id| raw.iter().find(|(known, _)| *known == id).unwrap().1;
                        contacts_alone(find(hull), find(other))
                    };
                    let found: Vec<_> =
                        pair.contacts(8).iter().map(|contact| (contact.position, contact.depth)).collect();
                    assert_eq!(found, expected);
                    touching += usize::from(!found.is_empty());
                    queried += 1;
                }
            })
            .unwrap();
        let used = self.prefetch(|prefetch| prefetch.used);
        assert!(used <= queried);
        (touching, used)
    }

    fn prefetch<R>(&self, read: impl FnOnce(&ContactPrefetch) -> R) -> R {
        // SAFETY: the world outlives the id, which is not followed.
        let raw = unsafe { self.world.geom(self.hull).raw() };
        let geom = class::find(raw).unwrap();
        read(lock(&geom.prefetch).as_ref().unwrap())
    }
}

/// One of each class that is sampled; the mesh and the convex are tetrahedra.
fn shapes() -> [Shape; 6] {
    let corners = vec![
        point![0.0, 0.0, 0.1],
        point![0.1, 0.0, -0.05],
        point![-0.05, 0.09, -0.05],
        point![-0.05, -0.09, -0.05],
    ];
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    let polygons: Vec<Vec<u32>> = faces.iter().map(|face| face.to_vec()).collect();
    [
        Shape::cuboid(0.1, 0.2, 0.25),
        Shape::Sphere { radius: 0.09 },
        Shape::Capsule { radius: 0.05, length: 0.12 },
        Shape::Cylinder { radius: 0.06, length: 0.15 },
        Shape::Convex(Arc::new(Convex::new(corners.clone(), &polygons).unwrap())),
        Shape::TriMesh(Arc::new(TriMesh::new(corners, faces.to_vec()).unwrap())),
    ]
}

/// Positions and depths of the contacts that a geom has alone, in the frame in force.
///
/// # Safety
/// Both are living.
unsafe fn contacts_alone(hull: dGeomID, other: dGeomID) -> Vec<(Point3<f64>, f64)> {
    let geom = class::find(hull).unwrap();
    // SAFETY: the caller vouches for the geom, of which the pose is its own.
    let (pose, samples) = unsafe {
        let pose = convert::any_pose(other);
        (pose, body_samples::of(other, &pose, geom.min_feature()).unwrap().samples.unwrap())
    };
    let (frame, last_escape) = (geom.hull().unwrap(), geom.last_contacts.escape(other as usize));
    let contacts = contact::collide(&frame, &samples, &pose, &geom.settings(), last_escape);
    contacts.points.iter().map(|point| (point.point, point.depth)).collect()
}

fn kinds() -> [Option<SpaceKind>; 5] {
    let extents = vector![2.0, 2.0, 2.0];
    [
        None,
        Some(SpaceKind::Simple),
        Some(SpaceKind::Hash { min_level: -3, max_level: 3 }),
        Some(SpaceKind::SweepAndPrune(SweepAxes::Xyz)),
        Some(SpaceKind::QuadTree { center: Point3::origin(), extents, depth: 3 }),
    ]
}

#[test]
fn bodies_in_every_kind_of_space_have_the_contacts_that_they_have_alone() {
    for kind in kinds() {
        let mut flight = Flight::new(kind);
        let (mut touching, mut used) = (0, 0);
        for step in 0..12 {
            if step % 3 == 0 {
                flight.show(step);
            }
            flight.fly(step);
            let (more_touching, more_used) = flight.collide();
            (touching, used) = (touching + more_touching, used + more_used);
        }
        assert!(touching > 60, "{touching} in {kind:?}");
        // Five of the six classes are prefetched, from the second step on. ODE cannot enumerate a quadtree.
        let expected = if matches!(kind, Some(SpaceKind::QuadTree { .. })) { 0..12 } else { 60..200 };
        assert!(expected.contains(&used), "{used} in {kind:?}");
    }
}

#[test]
fn addresses_of_removed_geoms_are_not_followed() {
    let mut flight = Flight::new(None);
    let root = flight.world.root_space();
    flight.show(0);
    for step in 0..30 {
        flight.fly(step);
        flight.collide();
        // In each step one geom goes and another comes, perhaps at the same address.
        let (body, geom) = flight.flyers.remove(step % 5);
        flight.world.remove_geom(geom);
        flight.world.remove_body(body);
        flight.add(root, &shapes()[step % 6]);
    }
}

#[test]
fn a_new_frame_or_setting_between_two_queries_invalidates_prefetched_contacts() {
    let mut flight = Flight::new(None);
    flight.show(0);
    for step in 0..12 {
        // From one collide to the next only the person moves.
        flight.fly(step / 4);
        match step % 4 {
            1 => flight.show(step),
            2 => flight.world.hull_mut(flight.hull).set_max_depth(0.01 + 0.001 * step as f64).unwrap(),
            3 => flight.world.hull_mut(flight.hull).set_min_feature(0.02 + 0.001 * step as f64).unwrap(),
            _ => {}
        }
        flight.collide();
    }
}

#[test]
fn prefetching_stops_in_programs_that_move_bodies_between_queries() {
    let mut flight = Flight::new(None);
    flight.show(0);
    for step in 0..40 {
        for k in 0..5 {
            // The other bodies are where they were, but their prefetched contacts are of no use once they move.
            flight.fly(5 * step + k);
            let other = flight.flyers[k].1;
            let contacts = flight.world.collide_geoms(flight.hull, other, 8).unwrap();
            // SAFETY: the world keeps both geoms.
            let expected = unsafe {
                contacts_alone(flight.world.geom(flight.hull).raw(), flight.world.geom(other).raw())
            };
            assert_eq!(contacts.len(), expected.len());
        }
    }
    assert!(flight.prefetch(|prefetch| prefetch.cooldown) > 0);
}

#[test]
fn threads_that_share_the_pairs_of_a_step_get_the_contacts_of_each_body_alone() {
    const THREADS: usize = 4;
    let mut flight = Flight::new(None);
    flight.show(0);
    flight.world.collide(|_| ()).unwrap();
    // SAFETY: the world keeps the geoms until the threads are done.
    let raw = |flight: &Flight, id| unsafe { flight.world.geom(id).raw() } as usize;
    let hull = raw(&flight, flight.hull);
    // Meshes are left out: this build of ODE cannot read two at a time.
    let others: Vec<_> = flight.flyers.iter().enumerate().filter(|(k, _)| k % 6 != 5).collect();
    let others: Vec<_> = others.into_iter().map(|(_, &(_, geom))| raw(&flight, geom)).collect();
    for step in 0..60 {
        flight.fly(step);
        std::thread::scope(|scope| {
            for thread in 0..THREADS {
                let others = &others;
                scope.spawn(move || {
                    for &other in others.iter().skip(thread).step_by(THREADS) {
                        let mut found = [dContactGeom::default(); 8];
                        // SAFETY: living geoms that no thread moves, and room for eight contacts.
                        unsafe {
                            dAllocateODEDataForThread(dAllocateMaskAll as u32);
                            let expected = contacts_alone(hull as dGeomID, other as dGeomID);
                            let size = size_of::<dContactGeom>() as i32;
                            let count =
                                dCollide(hull as dGeomID, other as dGeomID, 8, found.as_mut_ptr(), size);
                            let depths = found[..count as usize].iter().map(|contact| contact.depth);
                            assert!(depths.eq(expected.iter().map(|(_, depth)| *depth)));
                        }
                    }
                });
            }
        });
    }
}
