use crate::camera::Ray;
use crate::synthetic::Subject;
use nalgebra::{Isometry3, Point3, Vector3, vector};

#[test]
fn palms_face_each_other_at_the_stated_gap_wherever_the_hands_are() {
    let pose = Isometry3::new(vector![0.3, -0.2, 1.1], vector![0.4, -0.3, 0.9]);
    for gap in [0.05, 0.188, 0.4] {
        let hands = Subject::hands(&pose, gap);
        // At the height of a finger, where the palm is a tube along the ray's normal.
        let middle = pose * Point3::new(0.0, 0.0, 0.012);
        let to_palm = |side: f64| {
            let ray = Ray { origin: middle, direction: pose * (side * Vector3::x()) };
            hands.first_hit(&ray).map_or(f64::INFINITY, |(hit, _)| hit.t)
        };
        // Rounding of a few operations.
        assert!((to_palm(1.0) + to_palm(-1.0) - gap).abs() < 1e-9);
        assert!((to_palm(1.0) - to_palm(-1.0)).abs() < 1e-9);
    }
}
