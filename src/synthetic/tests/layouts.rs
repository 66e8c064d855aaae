use super::*;

fn tent_height(cameras: &[Camera]) -> f64 {
    Tent::above(cameras, Point3::new(0.0, 0.0, 0.4), 0.4).unwrap().middle
}

fn ring_at_elevation(degrees: f64) -> Vec<Camera> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let top = Point3::new(0.0, 0.0, 0.4);
    layout::ring(6, 3.0 * cos, 0.4 + 3.0 * sin, top, (64, 48), 0.6).unwrap()
}

#[test]
fn the_tent_above_a_table_shrinks_with_the_cameras_elevation() {
    let heights = [30.0, 15.0, 5.0, 0.0].map(|degrees| tent_height(&ring_at_elevation(degrees)));
    // Two of six cameras look perpendicularly at a face: the far edge of the top, 0.2 m behind its middle, sets the
    // height.
    for (degrees, height) in [30.0f64, 15.0, 5.0].into_iter().zip(heights) {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let expected = 0.2 * 3.0 * sin / (3.0 * cos + 0.2);
        assert!((height - expected).abs() < 1e-6, "{degrees} degrees: {height}, expected {expected}");
    }
    assert!(heights[3] < 1e-6, "a camera along the top leaves no tent: {}", heights[3]);
}

#[test]
fn tents_have_their_measured_height_with_a_camera_above() {
    // Measured with images: pixels enlarge the hull, hence the tolerance of 5 %.
    for (degrees, measured) in [(30.0, 0.109), (15.0, 0.051), (5.0, 0.017)] {
        let mut cameras = ring_at_elevation(degrees);
        let (eye, top) = (Point3::new(0.0, 0.0, 3.4), Point3::new(0.0, 0.0, 0.4));
        cameras.push(Camera::look_at("above", (64, 48), 0.6, eye, top, Vector3::y()).unwrap());
        let tent = Tent::above(&cameras, top, 0.4).unwrap();
        assert_eq!(tent.cameras.len(), 7);
        assert!((tent.highest - measured).abs() < 0.05 * measured, "{degrees} degrees: {tent:?}");
        cameras.push(ring_at_elevation(0.0).swap_remove(0));
        assert!(
            Tent::above(&cameras, top, 0.4).unwrap().highest < 1e-6,
            "one camera that looks along the top is enough"
        );
    }
}

#[test]
fn cameras_that_do_not_see_the_top_bound_no_tent() {
    let tent = Tent::above(&ring_at_elevation(30.0), Point3::new(50.0, 0.0, 0.4), 0.4).unwrap();
    assert!(tent.cameras.is_empty() && tent.middle >= 3.9);
    assert!(Tent::above(&[], Point3::origin(), -1.0).is_err());
}

#[test]
fn staggered_cameras_stand_at_each_height_in_turn() {
    let heights = [0.4, 0.6, 0.8, 1.0];
    let target = Point3::new(0.5, -0.2, 0.7);
    let cameras = layout::staggered(8, 3.0, &heights, target, (64, 48), 0.6).unwrap();
    for (i, camera) in cameras.iter().enumerate() {
        assert!((camera.centre().z - heights[i % 4]).abs() < 1e-9);
        assert!(((camera.centre() - target).xy().norm() - 3.0).abs() < 1e-9);
        assert_eq!(camera.name(), format!("cam{i}"));
    }
}

#[test]
fn a_hemisphere_is_uniform_and_looks_at_its_target() {
    let target = Point3::new(0.5, -0.2, 0.7);
    let cameras = layout::hemisphere(16, 3.0, target, (64, 48), 0.6).unwrap();
    let offsets: Vec<_> = cameras.iter().map(|camera| camera.centre() - target).collect();
    let mean_height = offsets.iter().map(|offset| offset.z).sum::<f64>() / 16.0;
    assert!((mean_height - 1.5).abs() < 1e-9, "half the radius, as on a uniform hemisphere");

    for (i, camera) in cameras.iter().enumerate() {
        assert!((offsets[i].norm() - 3.0).abs() < 1e-9 && offsets[i].z > 0.0);
        let middle = camera.project(&target).unwrap();
        assert!((middle.u - 32.0).abs() < 1e-9 && (middle.v - 24.0).abs() < 1e-9);
        let nearest = (0..16).filter(|&j| j != i).map(|j| (offsets[j] - offsets[i]).norm());
        // Sixteen equal caps on a hemisphere of 3 m have centres about 1.8 m apart.
        assert!(nearest.fold(f64::INFINITY, f64::min) > 1.2);
    }
}

#[test]
fn impossible_layouts_are_refused() {
    let ring = |n, radius, fov| layout::ring(n, radius, 1.0, Point3::origin(), (64, 48), fov);
    assert!(ring(0, 3.0, 0.6).is_err() && ring(4, 0.0, 0.6).is_err() && ring(4, f64::NAN, 0.6).is_err());
    assert!(
        ring(4, 3.0, 4.0).unwrap_err().to_string().starts_with("camera \"cam0\": expected a field of view")
    );
    assert!(layout::staggered(4, 3.0, &[], Point3::origin(), (64, 48), 0.6).is_err());
    assert!(layout::hemisphere(4, -1.0, Point3::origin(), (64, 48), 0.6).is_err());
    assert!(layout::ring(4, 3.0, f64::NAN, Point3::origin(), (64, 48), 0.6).is_err());
}
