//! Points that move enter a hull that moves when its warped silhouettes say so.

use image::GrayImage;
use nalgebra::{Point3, Vector3, point};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{Aabb, EdgeModel, Hull, HullData, Motion, Unseen, View};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::scene::{at, publish, show_table, table};
use std::sync::Arc;

/// Frames a second.
const RATE: f64 = 30.0;

/// The size of a pixel at the middle of the ring, in metres: 0.8 rad over 320 pixels at 3 m.
const PIXEL: f64 = 0.008;

fn cameras() -> Vec<Camera> {
    layout::ring(5, 3.0, 0.4, point![0.0, 0.0, 0.0], (320, 240), 0.8).unwrap()
}

/// Two balls and a capsule that move at up to 3 m/s.
#[derive(Debug, Clone, Copy)]
struct Moving {
    places: [Vector3<f64>; 3],
    velocities: [Vector3<f64>; 3],
}

fn vector(random: &mut Random, most: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.between(-most, most))
}

impl Moving {
    fn random(random: &mut Random) -> Self {
        let places = std::array::from_fn(|_| vector(random, 0.3));
        Self { places, velocities: std::array::from_fn(|_| vector(random, 1.7)) }
    }

    fn masks(&self, cameras: &[Camera], time: f64) -> Vec<GrayImage> {
        let solids =
            [Solid::sphere(0.1).unwrap(), Solid::sphere(0.06).unwrap(), Solid::capsule(0.04, 0.3).unwrap()];
        let placed =
            solids.into_iter().zip(self.places).zip(self.velocities).map(|((solid, place), velocity)| {
                let place = place + velocity * time;
                Placed::new(solid, at(place.x, place.y, place.z), Texture::plain([200; 3]))
            });
        let subject = Subject::new(placed.collect());
        cameras.iter().map(|camera| coverage(camera, &subject)).collect()
    }
}

fn data(unseen: Unseen) -> Arc<HullData> {
    let data = HullData::new();
    data.add_views(&cameras()).unwrap();
    data.set_bounds(Aabb::new(point![-1.0, -1.0, -1.0], point![1.0, 1.0, 1.0]).unwrap()).unwrap();
    data.set_unseen(unseen).unwrap();
    Arc::new(data)
}

/// The hull at a time by its frames, in a warp of its own.
fn hull_at(data: &HullData, motion: Motion, time: f64) -> Arc<Hull> {
    let asked = if motion == Motion::Predicted { time } else { time + 1.0 / RATE };
    data.in_motion(motion, asked).unwrap()
}

/// Whether a view shows a point inside the silhouette, more than a pixel from the edge.
fn is_deep_in(view: &View, point: &Point3<f64>) -> bool {
    let Some((i, j)) = view.pixel(point) else { return false };
    view.silhouette().nearest_background(i, j, 1).is_none()
}

#[test]
fn a_point_enters_where_the_silhouettes_of_that_time_first_hold_it() {
    let (mut entries, mut random) = (0, Random(5));
    for round in 0..24 {
        let subject = Moving::random(&mut random);
        let data = data(if round % 3 == 0 { Unseen::ABSTAIN } else { Unseen::Outside });
        for frame in 0..3 {
            publish(&data, &subject.masks(&cameras(), f64::from(frame) / RATE), f64::from(frame) / RATE);
        }
        let motion = if round % 2 == 0 { Motion::Interpolated } else { Motion::Predicted };
        let shown = if motion == Motion::Predicted { 2.1 } else { 1.0 + random.between(0.0, 0.7) } / RATE;
        let seconds = 0.3 / RATE;
        let hull = hull_at(&data, motion, shown);
        let later: Vec<(f64, Arc<Hull>)> = (0..=8)
            .map(|k| seconds * f64::from(k) / 8.0)
            .map(|after| (after, hull_at(&data, motion, shown + after)))
            .collect();

        for _ in 0..1000 {
            let start = Point3::from(vector(&mut random, 0.4));
            let velocity = vector(&mut random, 8.0);
            if hull.inside_by(&start, EdgeModel::Coverage) {
                continue;
            }
            let entry = hull.first_entry(&start, &velocity, seconds);
            let until = entry.map_or(seconds, |entry| entry.seconds);

            // Until then each warped hull leaves the point outside, or at most beside an edge: warped masks are rounded.
            for (after, hull) in later.iter().filter(|(after, _)| *after < until) {
                let point = start + velocity * *after;
                let is_deep = hull.inside(&point) && hull.views().iter().all(|view| is_deep_in(view, &point));
                assert!(!is_deep, "{round}: deep {after} s after, before it enters at {until} s");
            }
            let Some(entry) = entry else { continue };
            entries += 1;
            assert!((entry.normal.norm() - 1.0).abs() < 1e-9);

            // Then it lies at the edge of the silhouettes.
            let then = hull_at(&data, motion, shown + entry.seconds);
            let point = start + velocity * entry.seconds;
            assert!(!then.inside(&(point + entry.normal * PIXEL)), "{round}: {entry:?}");
            let view = &then.views()[entry.view];
            let deeper = view.project(&(point - entry.normal * PIXEL)).unwrap();
            let silhouette = view.silhouette();
            assert!(
                silhouette.is_subject(deeper.u.floor() as i32, deeper.v.floor() as i32),
                "{round}: {entry:?}"
            );
        }
    }
    assert!(entries > 200, "{entries} entries");
}

#[test]
fn a_point_enters_a_hull_at_rest_where_its_ray_does() {
    let (data, mut random) = (table(), Random(6));
    show_table(&data, 1.0);
    let hull = data.latest().unwrap().1;
    let (mut entries, step) = (0, 1.0 / 60.0);
    for _ in 0..2000 {
        let start = Point3::from(vector(&mut random, 0.5));
        let velocity = vector(&mut random, 30.0);
        if hull.inside_by(&start, EdgeModel::Coverage) {
            continue;
        }
        let ray = Ray { origin: start, direction: velocity.normalize() };
        let hit = hull.ray_cast(&ray).and_then(|(entry, _)| entry);
        let expected = hit.filter(|hit| hit.t < velocity.norm() * step);
        match (hull.first_entry(&start, &velocity, step), expected) {
            (Some(entry), Some(hit)) => {
                entries += 1;
                // A quarter of a pixel, halved eight times, along a path that may cross the edge at a flat angle.
                let way = entry.seconds * velocity.norm();
                assert!((way - hit.t).abs() < 1e-3, "{way} m, by the ray {} m", hit.t);
                assert!(entry.normal.dot(&hit.normal) > 0.999, "{entry:?}, by the ray {hit:?}");
            }
            (None, None) => {}
            // A point may graze the hull by less than the least progress.
            (_, Some(hit)) => {
                let middle = ray.at(hit.t + 0.002);
                assert!(!hull.inside(&middle), "a hit at {} m is missed", hit.t);
            }
            (Some(entry), None) => panic!("{entry:?}, but no hit"),
        }
    }
    assert!(entries > 200, "{entries} entries");
}

#[test]
fn a_point_that_is_inside_or_outside_the_work_volume_does_not_enter() {
    let data = table();
    let hull = data.latest().unwrap().1;
    let up = Vector3::z();
    assert_eq!(hull.first_entry(&Point3::origin(), &up, 1.0), None);
    assert_eq!(hull.first_entry(&point![5.0, 0.0, 0.0], &up, 1.0), None);
    assert_eq!(hull.first_entry(&point![0.0, 0.0, 0.5], &Vector3::zeros(), 1.0), None);
    assert_eq!(hull.first_entry(&point![0.0, 0.0, 0.5], &-up, 0.0), None);
    // Through the work volume's top, 0.8 m above the origin, on to the table's, at 0.2 m.
    let entry = hull.first_entry(&point![0.0, 0.0, 5.0], &(-10.0 * up), 1.0).expect("the table");
    assert!((entry.seconds - 0.48).abs() < 1e-3, "{entry:?}");
}
