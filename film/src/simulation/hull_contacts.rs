//! By what bodies and hull collide: the contacts of the last step, and the samples of the bodies.

use super::Simulation;
use nalgebra::{Point3, Vector3};
use ode_visual_hull::ode::{ContactGeom, GeomId, HullView};

/// A contact of a virtual body with the hull, in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HullContact {
    /// Where they touch.
    pub position: Point3<f64>,
    /// The unit normal, out of the hull.
    pub normal: Vector3<f64>,
    /// How deep the body is in the hull along the normal, in metres; 0 where it will only touch it within the step, see
    /// [`Swept`](ode_visual_hull::ode::Swept).
    pub depth: f64,
    /// The velocity of the real surface there, in m/s; zero where it is not known.
    pub velocity: Vector3<f64>,
}

impl HullContact {
    /// The contact of a pair of which one is the geom `hull`, with a surface at rest.
    pub(super) fn new(contact: &ContactGeom, hull: GeomId) -> Self {
        let into_first = contact.normal;
        let normal = if contact.geoms[0] == hull { -into_first } else { into_first };
        Self { position: contact.position, normal, depth: contact.depth, velocity: Vector3::zeros() }
    }

    /// Finds the velocity of the surface. The hull has it already, for the contact joints.
    pub(super) fn find_velocity(&mut self, hull: &HullView<'_>) {
        self.velocity = hull.point_velocity(&self.position).unwrap_or_default();
    }
}

impl Simulation {
    /// The contacts between bodies and hull in the last step; none before the first, and none of bodies that stick to the
    /// hull.
    pub fn hull_contacts(&self) -> &[HullContact] {
        &self.hull_contacts
    }

    /// The points of the bodies' surfaces by which they collide with the hull, in the world's frame, body by body as they
    /// were added. A body that cannot be sampled has none.
    pub fn sample_points(&self) -> Vec<Point3<f64>> {
        let hull = self.world.hull(self.hull);
        let mut points = Vec::new();
        for one in &self.bodies {
            for geom in self.world.geoms_of(one.id) {
                let Ok(Some(samples)) = hull.samples(geom) else { continue };
                let pose = self.world.geom(geom).pose();
                points.extend(samples.points().iter().map(|sample| pose * sample.point));
            }
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::part::Part;
    use nalgebra::{Isometry3, vector};
    use ode_visual_hull::hull::{Aabb, HullData, Motion};
    use ode_visual_hull::ode::Shape;
    use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
    use std::sync::Arc;

    /// A column of 0.4 m on a side whose top is at z = 0.6 m, in masks at these times in seconds; it has moved by `velocity`
    /// since time 0.
    fn column(times: &[f64], velocity: Vector3<f64>) -> Arc<HullData> {
        let target = Point3::new(0.0, 0.0, 0.5);
        let cameras = layout::staggered(6, 3.0, &[0.6, 1.6], target, (320, 240), 0.7).unwrap();
        let data = Arc::new(HullData::new());
        data.add_views(&cameras).unwrap();
        let bounds = Aabb::new(Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 1.5)).unwrap();
        data.set_bounds(bounds).unwrap();

        let solid = Solid::cuboid(vector![0.4, 0.4, 0.4]).unwrap();
        for &time in times {
            let pose = Isometry3::translation(0.0, 0.0, 0.4)
                * Isometry3::from_parts((time * velocity).into(), Default::default());
            let subject = Subject::new(vec![Placed::new(solid, pose, Texture::plain([0; 3]))]);
            for (view, camera) in cameras.iter().enumerate() {
                data.set_mask_at(view, &coverage(camera, &subject), time).unwrap();
            }
            data.update(time).unwrap();
        }
        data
    }

    fn cube_at(height: f64, data: &Arc<HullData>, motion: Motion) -> Simulation {
        let mut simulation = Simulation::new(data, 0.005, motion).unwrap();
        simulation.add(&Shape::cube(0.2), &Isometry3::translation(0.0, 0.0, height), [0; 3]).unwrap();
        simulation
    }

    #[test]
    fn contacts_of_a_box_that_lies_on_the_hull_are_at_its_base_and_point_up() {
        let mut simulation = cube_at(0.696, &column(&[0.0], Vector3::zeros()), Motion::Held);
        assert!(simulation.hull_contacts().is_empty());
        simulation.step(1.0 / 240.0).unwrap();
        let contacts = simulation.hull_contacts();
        assert!(!contacts.is_empty());
        for contact in contacts {
            // The hull is exact to a third of a pixel of 10 mm, and the box is 4 mm deep.
            assert!((contact.position.z - 0.598).abs() < 0.008, "{contact:?}");
            assert!(contact.normal.z > 0.95 && (contact.normal.norm() - 1.0).abs() < 1e-9, "{contact:?}");
            assert!(
                (0.0..0.012).contains(&contact.depth) && contact.velocity == Vector3::zeros(),
                "{contact:?}"
            );
        }

        // What is in the air or on the floor has none.
        let mut away = cube_at(1.2, &column(&[0.0], Vector3::zeros()), Motion::Held);
        away.add(&Shape::cube(0.2), &Isometry3::translation(0.8, 0.0, 0.1), [0; 3]).unwrap();
        away.step(1.0 / 240.0).unwrap();
        assert!(away.hull_contacts().is_empty());
    }

    #[test]
    fn contacts_with_a_surface_that_moves_tell_its_velocity() {
        let velocity = vector![0.0, 0.0, 0.6];
        let times: Vec<_> = (0..4).map(|k| f64::from(k) / 30.0).collect();
        let data = column(&times, velocity);
        let mut simulation = cube_at(0.696 + 0.6 * 0.1, &data, Motion::Predicted);
        simulation.skip(0.1);
        simulation.step(1.0 / 240.0).unwrap();
        let contacts = simulation.hull_contacts();
        assert!(!contacts.is_empty());
        for contact in contacts {
            // A frame in which the edges are off by a tenth of a pixel of 10 mm changes the speed by 0.03 m/s.
            assert!((contact.velocity - velocity).norm() < 0.1, "{contact:?}");
        }
    }

    #[test]
    fn the_samples_of_bodies_lie_on_the_surfaces_of_their_solid_parts() {
        let mut simulation = Simulation::new(&Arc::new(HullData::new()), 0.005, Motion::Held).unwrap();
        simulation.set_min_feature(0.05).unwrap();
        let ball = Part::new(Shape::Sphere { radius: 0.1 }, [0; 3]);
        let far = Isometry3::translation(0.5, 0.0, 0.0);
        let parts = [ball.clone(), ball.clone().at(far), ball.at(far * far).only_drawn()];
        let pose = Isometry3::new(vector![0.3, 0.2, 1.0], vector![0.0, 0.4, 0.2]);
        simulation.add_parts(&parts, &pose).unwrap();

        let in_body: Vec<_> = simulation.sample_points().iter().map(|point| pose.inverse() * point).collect();
        let on = |centre: f64| {
            let is_on =
                |point: &&Point3<f64>| ((**point - Point3::new(centre, 0.0, 0.0)).norm() - 0.1).abs() < 1e-9;
            in_body.iter().filter(is_on).count()
        };
        assert!(on(0.0) > 50);
        assert_eq!((on(0.0), on(1.0)), (on(0.5), 0));
        assert_eq!(on(0.0) + on(0.5), in_body.len());
    }
}
