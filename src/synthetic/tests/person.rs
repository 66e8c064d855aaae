use super::*;

/// The lowest z of a person and the highest of its trunk and head; all parts are capsules.
fn reach(person: &Subject) -> (f64, f64) {
    let mut reach = (f64::INFINITY, f64::NEG_INFINITY);
    for placed in person.solids() {
        let Solid::Capsule { radius, length } = *placed.solid() else {
            panic!("a part that is not a capsule")
        };
        let half = (placed.world_from_solid() * Vector3::z()).z.abs() * 0.5 * length;
        reach.0 = reach.0.min(placed.centre().z - half - radius);
        if placed.centre().y.abs() < 0.1 {
            reach.1 = reach.1.max(placed.centre().z + half + radius);
        }
    }
    reach
}

#[test]
fn a_foot_is_on_the_floor_at_every_time() {
    for i in 0..240 {
        let (lowest, highest) = reach(&Subject::person_at(f64::from(i) * 0.011));
        assert!(lowest.abs() < 1e-9, "soles at {lowest}");
        assert!((1.72..1.76).contains(&highest), "{highest} m tall");
    }
}

#[test]
fn a_person_moves_smoothly_and_returns() {
    let centres = |t: f64| -> Vec<Point3<f64>> {
        Subject::person_at(t).solids().iter().map(|placed| placed.centre()).collect()
    };
    let dt = 0.005;
    let mut fastest = 0.0f64;
    for i in 0..240 {
        let t = f64::from(i) * dt;
        for ((a, b), c) in centres(t).iter().zip(centres(t + dt)).zip(centres(t + 2.0 * dt)) {
            let (before, after) = ((b - a) / dt, (c - b) / dt);
            fastest = fastest.max(before.norm());
            // A kink would be a jump of velocity that does not shrink with dt; 60 m/s2 bounds the feet's acceleration.
            assert!((after - before).norm() < 60.0 * dt, "t = {t}: {before:?} then {after:?}");
        }
    }

    assert!((1.0..4.0).contains(&fastest), "fastest part: {fastest} m/s");

    for (a, b) in centres(0.3).iter().zip(centres(0.3 + 5.0 * PERSON_PERIOD)) {
        assert!((a - b).norm() < 1e-9);
    }
    assert_eq!(Subject::person_at(f64::NAN), Subject::person_at(0.0));
}

#[test]
fn moving_a_person_moves_the_points_inside() {
    let motion = Isometry3::new(Vector3::new(1.0, -2.0, 0.1), Vector3::new(0.0, 0.0, 1.0));
    let (person, moved) = (Subject::person_at(0.4), Subject::person_at(0.4).transformed(&motion));
    let mut random = Random::new(9);
    for _ in 0..2000 {
        let point = Point3::new(random.even() - 0.5, random.even() - 0.5, 1.8 * random.even());
        assert_eq!(person.contains(&point), moved.contains(&(motion * point)));
    }
}
