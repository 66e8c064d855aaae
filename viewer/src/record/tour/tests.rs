use super::*;
use nalgebra::Vector3;

const SUBJECT: Aabb = Aabb { min: Point3::new(-0.5, -0.4, 0.0), max: Point3::new(0.5, 0.4, 1.8) };

fn camera() -> Camera {
    let (eye, target) = (Point3::new(3.0, 0.5, 1.2), Point3::new(0.1, -0.1, 1.0));
    Camera::look_at("left", (640, 480), 0.8, eye, target, Vector3::z()).unwrap()
}

fn parse(text: &str) -> std::result::Result<Tour, String> {
    Tour::parse(text, &[camera()], &SUBJECT)
}

#[test]
fn a_tour_passes_through_its_keys_and_stands_still_before_and_after_them() {
    let tour = parse(
        "[[key]]\ntime = 1\neye = [2, 0, 1]\ntarget = [0, 0, 1]\n\
         [[key]]\ntime = 2\nazimuth = 90\nelevation = 30\ndistance = 4\ntarget = [0, 0, 0]\nfield_of_view = 30\n\
         [[key]]\ntime = 4\ncamera = \"left\"\n",
    )
    .unwrap();
    for time in [-1.0, 0.0, 1.0] {
        assert!((tour.at(time).eye() - Point3::new(2.0, 0.0, 1.0)).norm() < 1e-9);
    }
    let second = tour.at(2.0);
    let expected = Point3::new(0.0, 4.0 * 30_f64.to_radians().cos(), 2.0);
    assert!(
        (second.eye() - expected).norm() < 1e-9 && (second.field_of_view.to_degrees() - 30.0).abs() < 1e-9
    );
    for time in [4.0, 9.0] {
        let (found, expected) = (tour.at(time).camera((640, 480)).unwrap(), camera());
        assert!((found.centre() - expected.centre()).norm() < 1e-9);
        assert!((found.forward() - expected.forward()).norm() < 1e-9);
        assert!((found.intrinsics() - expected.intrinsics()).norm() < 1e-6);
    }
}

#[test]
fn a_tour_moves_without_jumps_and_turns_by_the_shorter_way() {
    let tour = parse(
        "[[key]]\ntime = 0\nazimuth = 170\ndistance = 2\n[[key]]\ntime = 1\nazimuth = -170\ndistance = 3\n\
         [[key]]\ntime = 3\nazimuth = -100\ndistance = 2.5\n",
    )
    .unwrap();
    let eyes: Vec<_> = (0..=300).map(|k| tour.at(f64::from(k) / 100.0).eye()).collect();
    let steps = || eyes.windows(2).map(|pair| (pair[1] - pair[0]).norm());
    // The longest way, 70 degrees at 3 m, in 2 s is 1.8 m/s on average; a cubic is at most half as fast again.
    assert!(steps().fold(0.0, f64::max) < 0.01 * 1.5 * 1.9, "{:?}", steps().fold(0.0, f64::max));
    // 20 degrees apart, not 340.
    assert!((0..100).all(|k| tour.at(f64::from(k) / 100.0).azimuth.to_degrees() > 169.0));
}

#[test]
fn a_circle_ends_where_it_begins_and_always_sees_the_middle_of_the_subject() {
    let tour = Tour::circle(&SUBJECT, 0.3, 6.0);
    assert!((tour.at(0.0).eye() - tour.at(6.0).eye()).norm() < 1e-9);
    for k in 0..60 {
        let camera = tour.at(f64::from(k) / 10.0).camera((320, 240)).unwrap();
        let pixel = camera.project(&SUBJECT.centre()).unwrap();
        assert!((pixel.u - 160.0).abs() < 1e-6 && (pixel.v - 120.0).abs() < 1e-6);
    }
}

#[test]
fn a_tour_that_is_none_says_which_key_and_what_was_expected() {
    let key = |lines: &str| format!("[[key]]\ntime = 0\neye = [1, 0, 1]\n[[key]]\n{lines}");
    let refused = [
        ("", "expected a tour with [[key]] tables"),
        ("key = []", "expected at least one [[key]], found none"),
        ("[[key]]\ntime = 0\nspeed = 3", "unknown field `speed`"),
        (
            &key("time = 0\neye = [1, 0, 1]"),
            "key 2: expected a time in seconds after that of the key before, found 0",
        ),
        (&key("time = 1"), "key 2: expected either eye, or azimuth and distance, or camera"),
        (&key("time = 1\ncamera = \"right\""), "key 2: camera: expected one of left, found right"),
        (&key("time = 1\neye = [nan, 0, 1]"), "key 2: expected finite numbers, found nan or inf"),
        (&key("time = 1\nazimuth = 1\ndistance = 0"), "key 2: expected an eye away from the target"),
        (
            &key("time = 1\neye = [1, 0, 1]\nfield_of_view = 180"),
            "key 2: field_of_view: expected 1 to 150 degrees, found 180",
        ),
    ];
    for (text, expected) in refused {
        let message = parse(text).unwrap_err();
        assert!(message.contains(expected), "{text}: {message}");
    }
}
