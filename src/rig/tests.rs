mod fisheye;

use super::*;

fn camera(name: &str, eye: [f64; 3]) -> Camera {
    let target = Point3::new(0.0, 0.0, 1.0);
    Camera::look_at(name, (640, 480), 1.0, Point3::from(eye), target, Vector3::z()).unwrap()
}

fn rig() -> Rig {
    Rig::new(vec![camera("left", [3.0, 0.0, 1.0]), camera("right", [0.0, -2.5, 1.5])]).unwrap()
}

#[test]
fn cameras_keep_their_order_and_are_found_by_name() {
    let rig = rig();
    assert_eq!(rig.len(), 2);
    assert_eq!(rig.index_of("right"), Some(1));
    assert_eq!(rig.index_of("top"), None);
    assert_eq!(rig.cameras()[0].name(), "left");
}

#[test]
fn an_empty_rig_and_ambiguous_names_are_refused() {
    assert!(Rig::new(vec![]).unwrap_err().to_string().contains("at least one camera"));
    let twice = vec![camera("left", [3.0, 0.0, 1.0]), camera("left", [0.0, 3.0, 1.0])];
    let message = Rig::new(twice).unwrap_err().to_string();
    assert!(message.contains("camera \"left\"") && message.contains("positions 0 and 1"), "{message}");
    let nameless = Rig::new(vec![camera("", [3.0, 0.0, 1.0])]).unwrap_err().to_string();
    assert!(nameless.contains("expected a name for camera 0"), "{nameless}");
}

#[test]
fn moving_the_rig_and_the_subject_together_changes_no_image() {
    let motion = Isometry3::new(Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 1.1, -0.4));
    let (old, new) = (rig(), rig().transformed(&motion).unwrap());
    let point = Point3::new(0.2, 0.1, 0.9);
    for (a, b) in old.cameras().iter().zip(new.cameras()) {
        let (a, b) = (a.project(&point).unwrap(), b.project(&(motion * point)).unwrap());
        // A few roundings at coordinates of about 500 px.
        assert!((a.u - b.u).abs() < 1e-9 && (a.v - b.v).abs() < 1e-9 && (a.depth - b.depth).abs() < 1e-12);
    }
    let broken = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(rig().transformed(&broken).unwrap_err().to_string().contains("finite pose"));
}

#[test]
fn the_description_shows_place_direction_width_and_origin() {
    let text = rig().describe();
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(lines.len(), 2);
    // One radian is 57.3 degrees; the origin lies 1 m below the target, vertically below the image's centre.
    let focal = 320.0 / 0.5_f64.tan();
    let origin = format!("origin at (320.0, {:.1}) px", 240.0 + focal / 3.0);
    assert!(lines[0].starts_with("left   640 x 480  at (3.000, 0.000, 1.000) m"), "{}", lines[0]);
    assert!(lines[0].contains("looks (-1.00, 0.00, 0.00)  sees 57.3 deg"), "{}", lines[0]);
    assert!(lines[0].ends_with(&origin), "{}", lines[0]);
}

#[test]
fn the_description_says_when_the_origin_is_behind_or_beside() {
    let away = Isometry3::translation(-10.0, 0.0, 0.0);
    let text = rig().transformed(&away).unwrap().describe();
    assert!(text.lines().next().unwrap().ends_with("origin behind it"), "{text}");
    assert!(text.lines().nth(1).unwrap().ends_with("px, outside its image"), "{text}");
}

#[test]
fn the_work_volume_is_centred_at_the_focus() {
    let rig = rig();
    let focus = rig.focus().unwrap();
    assert!((focus - Point3::new(0.0, 0.0, 1.0)).norm() < 1e-9, "{focus}");
    assert_eq!(rig.seeing_focus().unwrap(), [0, 1]);
    let volume = rig.work_volume().unwrap();
    // The nearest camera is (0, 2.5, 0.5) away; the floor cuts off the lower part.
    let reach = 0.9 * 6.5_f64.sqrt();
    assert!((volume.max.x - reach).abs() < 1e-9 && volume.min.z == 0.0, "{volume:?}");
    let below = rig.transformed(&Isometry3::translation(0.0, 0.0, -5.0)).unwrap();
    assert!(below.work_volume().unwrap().min.z < -5.0, "no floor above the cameras");
}

#[test]
fn parallel_cameras_have_no_focus() {
    let beside = |name: &str, x: f64| {
        let (eye, target) = (Point3::new(x, 0.0, 1.0), Point3::new(x, 1.0, 1.0));
        Camera::look_at(name, (640, 480), 1.0, eye, target, Vector3::z()).unwrap()
    };
    let rig = Rig::new(vec![beside("a", 0.0), beside("b", 1.0)]).unwrap();
    assert!(rig.work_volume().unwrap_err().to_string().contains("found parallel ones"));
}

#[test]
fn coverage_is_the_share_seen_by_each_number_of_cameras() {
    let rig = rig();
    let near = crate::hull::Aabb::new(Point3::new(-0.1, -0.1, 0.9), Point3::new(0.1, 0.1, 1.1)).unwrap();
    assert_eq!(rig.coverage(&near, 4), [0.0, 0.0, 1.0]);
    let shares = rig.coverage(&rig.work_volume().unwrap(), 12);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12 && shares.iter().all(|&share| share > 0.0));
    let own: f64 = rig.cameras().iter().map(|c| Rig::coverage_of(c, &rig.work_volume().unwrap(), 12)).sum();
    assert!((own - shares[1] - 2.0 * shares[2]).abs() < 1e-12);
}

#[test]
fn a_pose_read_in_the_convention_it_was_written_in_is_right() {
    let right = rig();
    for convention in PoseConvention::ALL {
        // Each conversion is its own inverse except the last, whose parts are undone in reverse order.
        let wrong = match convention {
            PoseConvention::CameraToWorldOpenGl => {
                right.read_as(PoseConvention::OpenGl).unwrap().read_as(PoseConvention::CameraToWorld).unwrap()
            }
            other => right.read_as(other).unwrap(),
        };

        let back = wrong.read_as(convention).unwrap();
        for (a, b) in right.cameras().iter().zip(back.cameras()) {
            assert!((a.centre() - b.centre()).norm() < 1e-12 && (a.forward() - b.forward()).norm() < 1e-12);
        }
        assert!(wrong.seeing_focus().map_or(true, |cameras| cameras.len() < 2), "{convention:?}");
    }
}
