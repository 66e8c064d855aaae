//! Real calibration files of other tools are read, give plausible cameras, and survive a round trip through the crate's
//! format.

use nalgebra::{Matrix3, Point3, Vector3};
use ode_visual_hull::camera::{Camera, Distortion};
use ode_visual_hull::rig::{Calibration, Hints, Rig};
use ode_visual_hull_testing::captures;
use ode_visual_hull_testing::random::Random;
use std::path::PathBuf;

fn sample(path: &str) -> Option<PathBuf> {
    captures::find("calibration_samples").map(|folder| folder.join(path))
}

fn load(path: &str, size: Option<(u32, u32)>) -> Option<Rig> {
    let found = Calibration::load(sample(path)?, &Hints { size, metres_per_unit: None }).unwrap();
    println!("{path}: {}\n{}{}", found.format, found.rig.describe(), found.notes.join("\n"));
    Some(found.rig)
}

fn names(rig: &Rig) -> Vec<&str> {
    rig.cameras().iter().map(Camera::name).collect()
}

/// A thousand random points all over the camera's image, at depths of 0.3 to 8 m, without those beyond its lens model.
fn points_before(camera: &Camera) -> Vec<Point3<f64>> {
    let mut random = Random(1);
    let (width, height) = (f64::from(camera.size().0), f64::from(camera.size().1));
    let mut point =
        |_| camera.unproject(width * random.unit(), height * random.unit(), random.between(0.3, 8.0));
    (0..1000).filter_map(&mut point).collect()
}

fn distance(a: &Camera, b: &Camera, b_scale: f64, point: &Point3<f64>) -> f64 {
    let (a, b) = (a.project(point).unwrap(), b.project(point).unwrap());
    (a.u - b_scale * b.u).hypot(a.v - b_scale * b.v)
}

/// Asserts that points in front of each camera project to the same places after writing and reading the rig.
fn assert_survives_the_round_trip(rig: &Rig) {
    let again = Rig::from_toml(&rig.to_toml()).unwrap();
    for (a, b) in rig.cameras().iter().zip(again.cameras()) {
        assert_eq!((a.name(), a.size()), (b.name(), b.size()));
        let points = points_before(a);
        assert!(points.len() > 900, "{}: {} points within the lens model", a.name(), points.len());
        let most = points.iter().map(|point| distance(a, b, 1.0, point)).fold(0.0, f64::max);
        assert!(most < 1e-6, "{}: {most} px", a.name());
    }
}

/// The point nearest to all optical axes.
fn meeting_point(rig: &Rig) -> Point3<f64> {
    let (mut across, mut offset) = (Matrix3::zeros(), Vector3::zeros());
    for camera in rig.cameras() {
        let projection = Matrix3::identity() - camera.forward() * camera.forward().transpose();
        across += projection;
        offset += projection * camera.centre().coords;
    }
    Point3::from(across.try_inverse().unwrap() * offset)
}

/// Asserts that the cameras are upright and 0.5 to 4 m above a floor at z = 0, and that all of them see the point
/// nearest to their optical axes, at the height of people.
fn assert_stands_around_people(rig: &Rig) {
    let meeting = meeting_point(rig);
    assert!((-0.5..2.5).contains(&meeting.z), "{meeting}");
    for camera in rig.cameras() {
        assert!((0.5..4.0).contains(&camera.centre().z), "{}", camera.centre());
        let down = camera.cam_from_world().inverse_transform_vector(&Vector3::y());
        assert!(down.z < -0.8, "{}: {down}", camera.name());
        let seen = camera.project(&meeting).unwrap();
        let (width, height) = camera.size();
        let inside = (0.0..f64::from(width)).contains(&seen.u) && (0.0..f64::from(height)).contains(&seen.v);
        assert!(inside && (1.0..20.0).contains(&seen.depth), "{}: {seen:?}", camera.name());
    }
}

#[test]
fn a_calibration_by_anipose_is_read_and_written() {
    let Some(rig) = load("anipose_toml/calibration_4cam.toml", None) else { return };
    assert_eq!(names(&rig), ["1", "2", "3", "4"]);
    assert_eq!(rig.cameras()[1].intrinsics()[(0, 2)], 960.0);
    assert_survives_the_round_trip(&rig);
}

#[test]
fn middleburys_dinosaur_is_read_and_written() {
    let Some(rig) = load("middlebury_par/dinoSR_par.txt", Some((640, 480))) else { return };
    assert_eq!((rig.len(), rig.cameras()[15].name()), (16, "dinoSR0016"));
    // Distances by the length of the gantry's arm, and the centre of the dinosaur's bounding box.
    let centre = Point3::new(-0.025, 0.025, -0.021);
    for camera in rig.cameras() {
        assert!((0.5..0.8).contains(&(camera.centre() - centre).norm()), "{}", camera.centre());
        let seen = camera.project(&centre).unwrap();
        assert!((100.0..540.0).contains(&seen.u) && (100.0..380.0).contains(&seen.v), "{seen:?}");
    }
    assert_survives_the_round_trip(&rig);
}

#[test]
fn voxelposes_campus_and_shelf_are_read_and_written() {
    for (name, size, count) in [("campus", (360, 288), 3), ("shelf", (1032, 776), 5)] {
        let path = format!("panoptic_like_json/calibration_{name}.json");
        let Some(rig) = load(&path, Some(size)) else { return };
        assert_eq!(rig.len(), count);
        assert_stands_around_people(&rig);
        assert_survives_the_round_trip(&rig);
    }
}

#[test]
fn qualisys_export_is_read_and_written() {
    let Some(rig) = load("qualisys_qca/Calib.qca.txt", None) else { return };
    assert_eq!(names(&rig), ["cam01", "cam02", "cam03", "cam04"]);
    assert_stands_around_people(&rig);
    assert_survives_the_round_trip(&rig);
}

/// The published rig was made from this export for images of half the size, without the lens distortion. (Its tool
/// divides the coefficients by 64 as if they had a unit. With them, the hull of the recording is 0.1 to 0.7 % larger,
/// so that they seem right.) Apart from the distortion, all four cameras agree. Two of the videos were encoded anew and
/// differ from their calibration, but this does not change the calibration itself.
#[test]
fn qualisys_export_agrees_with_the_rig_that_was_published_from_it() {
    let Some(rig) = load("qualisys_qca/Calib.qca.txt", None) else { return };
    let Some(published) = captures::find("balancing_person/rig_as_published.toml") else { return };
    let published = Rig::load(published).unwrap();

    for (ours, theirs) in rig.cameras().iter().zip(published.cameras()) {
        assert_eq!(ours.size(), (2 * theirs.size().0, 2 * theirs.size().1));
        let (k, pose) = (*ours.intrinsics(), *ours.cam_from_world());
        let pinhole = Camera::new(ours.name(), ours.size(), k, Distortion::none(), pose).unwrap();

        let points = points_before(theirs);
        assert_eq!(points.len(), 1000);
        let most =
            |camera: &Camera| points.iter().map(|p| distance(camera, theirs, 2.0, p)).fold(0.0, f64::max);

        let (without_lens, with_lens) = (most(&pinhole), most(ours));
        println!("{}: {without_lens:.4} px, with its lens {with_lens:.1} px", ours.name());
        assert!(without_lens < 0.01, "{}: {without_lens} px", ours.name());
        assert!(with_lens < 10.0, "{}: {with_lens} px", ours.name());
    }
}

#[test]
fn the_inputs_of_a_self_calibration_are_refused() {
    let Some(folder) = sample("multicamselfcal") else { return };
    let message = Calibration::load(folder, &Hints::default()).unwrap_err().to_string();
    assert!(message.contains("expected camera1.Pmat.cal and so on, found only what"), "{message}");
}
