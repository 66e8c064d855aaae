//! A synthetic hand that is moved and turned by known poses before cameras.

use super::*;
use crate::hull::{Aabb, Unseen, View};
use crate::silhouette::{Border, Silhouette};
use crate::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use nalgebra::{UnitQuaternion, point, vector};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// The size of a pixel at the hand, in metres: 0.5 rad over 320 pixels at 2 m.
const PIXEL: f64 = 0.0032;

/// A hand about the origin: a palm of four capsules, four fingers, a thumb and a forearm.
fn hand(pose: &Isometry3<f64>) -> Subject {
    let capsule = |radius: f64, length: f64, place: Isometry3<f64>| {
        Placed::new(Solid::capsule(radius, length).unwrap(), pose * place, Texture::plain([200; 3]))
    };
    // Capsules are along z; the hand is along x.
    let along_x = UnitQuaternion::from_euler_angles(0.0, FRAC_PI_2, 0.0);
    let lies = |x: f64, y: f64| Isometry3::from_parts(vector![x, y, 0.0].into(), along_x);
    let across = [-0.033, -0.011, 0.011, 0.033];
    let mut parts: Vec<_> = across.iter().map(|&y| capsule(0.014, 0.07, lies(-0.02, y))).collect();
    parts.extend(across.iter().map(|&y| capsule(0.009, 0.06, lies(0.05, 1.3 * y))));
    let aside = UnitQuaternion::from_euler_angles(FRAC_PI_2 + 0.5, 0.0, 0.0);
    parts.push(capsule(0.011, 0.05, Isometry3::from_parts(vector![-0.03, 0.06, 0.01].into(), aside)));
    parts.push(capsule(0.035, 0.2, lies(-0.18, 0.0)));
    Subject::new(parts)
}

/// The hull of a subject in eight cameras.
fn hull_of(subject: &Subject, seconds: f64) -> Hull {
    let cameras =
        layout::staggered(8, 2.0, &[0.1, 0.9], Point3::origin(), (320, 240), 0.5).expect("a ring of eight");
    let views = cameras.into_iter().map(|camera| {
        let silhouette = Silhouette::new(&coverage(&camera, subject), Border::Background);
        View::new(Arc::new(camera), Arc::new(silhouette), None)
    });
    let bounds = Aabb::new(point![-0.8, -0.8, -0.8], point![0.8, 0.8, 0.8]).unwrap();
    Hull::new(views.collect(), bounds, Unseen::Outside, seconds)
}

/// Where a ball on the palm is.
const BALL: Point3<f64> = Point3::new(0.0, 0.0, 0.05);

/// The pose of a hand at a time: it turns by 80 degrees a second and moves at 0.6 m/s.
fn pose_at(seconds: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(vector![0.5, 0.3, 1.0].normalize() * (1.4 * seconds));
    Isometry3::from_parts((vector![0.4, -0.3, 0.33] * seconds).into(), turn)
}

#[test]
fn a_rim_lies_on_the_surface_but_for_corners_between_parts() {
    let subject = hand(&Isometry3::identity());
    let rim = rim::rim_around(&hull_of(&subject, 0.0), &BALL);
    assert!(rim.len() > 100, "{}", rim.len());
    // A pixel and a half: the edge is known to half a pixel, and the place on the line of sight to some millimetres. In a corner
    // between two parts the hull is larger than the hand.
    let is_beside =
        |point: &RimPoint, sign: f64| subject.contains(&(point.at - point.normal * (sign * 1.5 * PIXEL)));
    let on_surface = rim.iter().filter(|point| is_beside(point, 1.0) && !is_beside(point, -1.0)).count();
    assert!(on_surface as f64 > 0.8 * rim.len() as f64, "{on_surface} of {}", rim.len());
}

#[test]
fn a_hand_that_moves_and_turns_is_followed_to_half_a_pixel_each_time_that_its_rim_is_seen() {
    let mut track = Track::begin(&hull_of(&hand(&pose_at(0.0)), 0.0), &BALL).unwrap();
    for frame in 1..=30 {
        let seconds = f64::from(frame) / 30.0;
        assert_eq!(track.follow(&hull_of(&hand(&pose_at(seconds)), seconds)), Followed::Found);
        let (true_pose, found) = (pose_at(seconds), track.pose());
        let off = (found * BALL - true_pose * BALL).norm();
        let turned = found.rotation.angle_to(&true_pose.rotation);
        let seen = 1.0 + (true_pose.rotation.angle() / TURN_OF_RENEWAL).floor();
        assert!(off < seen * 0.5 * PIXEL, "{off} m after {seconds} s");
        // Half a pixel at half the length of the hand.
        assert!(turned < seen * 0.5 * PIXEL / 0.08, "{turned} rad after {seconds} s");
    }
}

#[test]
fn a_part_that_is_out_of_sight_goes_on_as_it_moved_until_it_is_lost() {
    let mut track = Track::begin(&hull_of(&hand(&pose_at(0.0)), 0.0), &BALL).unwrap();
    let nothing = Subject::new(Vec::new());
    for frame in 1..=4 {
        let seconds = f64::from(frame) / 30.0;
        assert_eq!(track.follow(&hull_of(&hand(&pose_at(seconds)), seconds)), Followed::Found);
    }
    let (before, speed) = (track.place(), track.motion().linear);
    assert_eq!(track.follow(&hull_of(&nothing, 0.2)), Followed::Hidden);
    // It fades a little in these 67 ms.
    let expected = before + speed * (0.2 - 4.0 / 30.0);
    assert!((track.place() - expected).norm() < 0.25 * (expected - before).norm());
    assert_eq!(track.follow(&hull_of(&nothing, 0.4)), Followed::Lost);
    assert!(Track::begin(&hull_of(&nothing, 0.0), &BALL).is_none());
}

#[test]
fn the_motion_of_a_path_that_accelerates_evenly_is_that_of_its_end() {
    let (acceleration, spin) = (vector![4.0, -9.0, 2.0], vector![1.0, 2.0, -0.5]);
    let mut path = Path::default();
    assert_eq!(path.motion(), None);
    for step in 0..48 {
        let seconds = f64::from(step) / 240.0;
        let centre = Point3::from(acceleration * (0.5 * seconds * seconds));
        path.push(seconds, centre, UnitQuaternion::from_scaled_axis(spin * seconds));
    }
    let motion = path.motion().unwrap();
    // A parabola and an even turn are fitted exactly, up to rounding.
    assert!((motion.linear - acceleration * (47.0 / 240.0)).norm() < 1e-9);
    assert!((motion.angular - spin).norm() < 1e-9);
}

#[test]
fn a_pose_is_advanced_about_the_point_that_moves() {
    let motion = RigidMotion { linear: vector![1.0, 0.0, 0.0], angular: vector![0.0, 0.0, FRAC_PI_2] };
    let centre = point![2.0, 0.0, 0.0];
    let pose = Isometry3::translation(2.0, 1.0, 0.0);
    let later = motion.advance(&pose, &centre, 1.0);
    assert!((later.translation.vector - vector![2.0, 0.0, 0.0]).norm() < 1e-12);
    assert!((motion.at(&vector![0.0, 1.0, 0.0]).linear - vector![1.0 - FRAC_PI_2, 0.0, 0.0]).norm() < 1e-12);
}
