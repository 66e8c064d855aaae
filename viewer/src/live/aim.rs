//! Where a ball is thrown that is aimed at a place in the picture.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Ray;
use ode_visual_hull_film::Simulation;

/// The speed of a ball in m/s, on the straight way to where it is aimed.
const SPEED: f64 = 6.0;

/// What is farther away than this is not aimed at, in metres: a ball would fly higher than a room.
const FARTHEST: f64 = 9.0;

/// The velocity in m/s with which a ball at `start` is thrown, so that it meets what `ray` meets first: a body, the subject or the
/// floor. Along the ray if that meets nothing, or only what is far away.
pub fn velocity(simulation: &Simulation, ray: &Ray, start: &Point3<f64>) -> Vector3<f64> {
    let seconds = |target: &Point3<f64>| (target - start).norm() / SPEED;
    match target(simulation, ray).filter(|target| (target - start).norm() <= FARTHEST) {
        Some(target) if target != *start => simulation.velocity_of_throw(start, &target, seconds(&target)),
        _ => ray.direction * SPEED,
    }
}

/// The first place on `ray` that is on a body, on the subject or on the floor.
fn target(simulation: &Simulation, ray: &Ray) -> Option<Point3<f64>> {
    let body = simulation.pick(ray).map(|(_, place)| (place - ray.origin).norm());
    let hit = simulation.hull().and_then(|hull| hull.ray_cast(ray));
    let subject = hit.and_then(|(entry, _)| entry).map(|entry| entry.t);
    let floor = Some(-ray.origin.z / ray.direction.z).filter(|t| *t > 0.0 && t.is_finite());
    let nearest = [body, subject, floor].into_iter().flatten().min_by(f64::total_cmp)?;
    Some(ray.at(nearest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Isometry3;
    use ode_visual_hull::hull::{HullData, Motion};
    use ode_visual_hull::shape::Shape;
    use std::sync::Arc;

    const BALL: Shape = Shape::Sphere { radius: 0.05 };

    #[test]
    fn a_ball_flies_to_the_body_or_the_place_of_the_floor_that_its_ray_meets_first() {
        let mut simulation = Simulation::new(&Arc::new(HullData::new()), 0.005, Motion::Held).unwrap();
        simulation.add(&Shape::cube(0.4), &Isometry3::translation(3.0, 0.0, 0.2), [0; 3]).unwrap();
        let start = Point3::new(0.0, 0.0, 1.5);
        let ball = simulation.add(&BALL, &start.into(), [0; 3]).unwrap();
        for (aimed_at, met) in [
            (Point3::new(3.0, 0.1, 0.3), Point3::new(2.8, 0.1 * 2.8 / 3.0, 0.38)),
            (Point3::new(2.0, 1.0, 0.0), Point3::new(2.0, 1.0, 0.0)),
        ] {
            let ray = Ray { origin: start, direction: (aimed_at - start).normalize() };
            simulation.place(ball, &start.into()).unwrap();
            simulation.set_velocity(ball, &velocity(&simulation, &ray, &start)).unwrap();
            let mut nearest = f64::INFINITY;
            for _ in 0..120 {
                simulation.step(1.0 / 240.0).unwrap();
                let centre = simulation.states()[ball].pose.translation.vector;
                nearest = nearest.min((centre - met.coords).norm());
            }
            // The ball's radius, and g t dt / 2 of a step that moves at the velocity of its end.
            assert!(nearest < 0.05 + 0.03, "{nearest} m from {met}");
        }
    }

    #[test]
    fn a_ball_that_is_aimed_at_nothing_near_flies_along_its_ray() {
        let simulation = Simulation::new(&Arc::new(HullData::new()), 0.005, Motion::Held).unwrap();
        let start = Point3::new(0.0, 0.0, 1.5);
        for direction in [Vector3::new(1.0, 0.0, 1.0), Vector3::new(1.0, 0.0, -0.01)] {
            let ray = Ray { origin: start, direction: direction.normalize() };
            assert_eq!(velocity(&simulation, &ray, &start), ray.direction * SPEED);
        }
    }
}
