//! Removal of transient contact points, which a tilted body touches before it has come down on them.
//!
//! ```text
//!          _____----
//!     ----      ____/       a box rotates about its deep edge, d, until its face lies on the hull
//!     |   __----            the sample s is barely inside: as a contact it would become the pivot and lift
//!     d-s----  hull         the edge, whereas a rigid box touches at its edge alone until the face is down
//! ```

use super::ManifoldPoint;
use super::tuning::{MIN_TILT, SHALLOW_RATIO};

/// Removes the transient points: each is much shallower than another point of its manifold, and so near to it that the
/// body must be tilting about that one.
pub(super) fn drop_transient_points(points: &mut Vec<ManifoldPoint>) {
    let is_transient = |shallow: &ManifoldPoint, points: &[ManifoldPoint]| {
        points.iter().any(|deep| {
            deep.manifold == shallow.manifold
                && shallow.depth < SHALLOW_RATIO * deep.depth
                && deep.depth - shallow.depth > MIN_TILT * (deep.point - shallow.point).norm()
        })
    };

    // By the triangle inequality the relation is transitive, so the order of removal does not matter.
    let mut k = 0;
    while k < points.len() {
        if is_transient(&points[k], points) {
            points.remove(k);
        } else {
            k += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    fn point(x: f64, depth: f64) -> ManifoldPoint {
        ManifoldPoint { point: Point3::new(x, 0.0, 0.0), depth, sample: None, manifold: 0 }
    }

    fn kept(mut points: Vec<ManifoldPoint>) -> Vec<ManifoldPoint> {
        drop_transient_points(&mut points);
        points
    }

    #[test]
    fn only_the_deep_edge_of_a_tilted_face_is_kept() {
        // The edge is 0.8 mm deep, a sample 2 cm beside it 0.2 mm: a tilt of 1.7 degrees.
        assert_eq!(kept(vec![point(0.0, 8e-4), point(0.02, 2e-4)]), [point(0.0, 8e-4)]);
    }

    #[test]
    fn all_points_of_a_flat_face_are_kept() {
        // A third of a pixel of noise over a face of 20 cm.
        let lying = vec![point(0.0, 1.2e-3), point(0.1, 0.9e-3), point(0.2, 0.5e-3)];
        assert_eq!(kept(lying.clone()), lying);
    }

    #[test]
    fn a_deep_point_of_another_manifold_makes_no_point_transient() {
        let side = ManifoldPoint { manifold: 1, ..point(0.02, 1e-4) };
        assert_eq!(kept(vec![point(0.0, 5e-3), side]).len(), 2);
    }
}
