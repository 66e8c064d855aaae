//! What a scene cannot show: viewpoints inside something, and cameras that do not see enough.

use super::{Mesh, Scene};
use nalgebra::Point3;

/// Real cameras whose directions to the subject are all within this angle of their mean, in radians, are on one side.
const ONE_SIDE: f64 = 1.05;

impl Scene {
    /// Why a picture from `eye` shows little or nothing, in words; `None` where nothing is in the way.
    pub fn obstacle(&self, eye: &Point3<f64>) -> Option<String> {
        if self.hull.inside(eye) {
            return Some("it is inside the subject, which is not drawn from there; move it away".into());
        }
        for (number, body) in (1..).zip(&self.bodies) {
            let in_body = body.world_from_body.inverse_transform_point(eye);
            if Mesh::of(&body.shape).contains(&in_body.cast()) {
                return Some(format!(
                    "it is inside body {number}, which is not drawn from there; move it away"
                ));
            }
        }
        let floor = self.floor.filter(|floor| eye.z < *floor)?;
        Some(format!("it is {:.2} m below the floor, which is not drawn from there; raise it", floor - eye.z))
    }

    /// What the real cameras cannot tell of the subject, in words.
    pub fn shortcomings(&self) -> Vec<String> {
        let mut found = Vec::new();
        let centre = self.hull.aabb().centre();
        let directions: Vec<_> = self.views.iter().map(|view| (view.centre() - centre).normalize()).collect();
        match self.views.as_slice() {
            [only] => found.push(format!(
                "{} alone sees the subject: its depth is not known, the hull reaches to the end of the work volume",
                only.camera().name()
            )),
            views => {
                let mean: nalgebra::Vector3<f64> = directions.iter().sum();
                let is_near = |direction: &nalgebra::Vector3<f64>| direction.angle(&mean) < ONE_SIDE;
                if directions.iter().all(is_near) {
                    found.push(format!(
                        "all {} cameras are on one side of the subject: the other side is drawn with the colours of this one",
                        views.len()
                    ));
                }
            }
        }

        let missing =
            self.views.iter().filter(|view| view.photo().is_none()).map(|view| view.camera().name());
        let missing: Vec<_> = missing.collect();
        if !missing.is_empty() {
            found.push(format!("no image of {}: only the silhouettes count", missing.join(", ")));
        }
        if self.touches_bounds() {
            found.push(
                "the subject reaches the end of the work volume, which cuts it off; set --bounds farther out"
                    .into(),
            );
        }
        found
    }

    /// Whether the hull is cut off by the work volume, other than at the floor.
    fn touches_bounds(&self) -> bool {
        let (subject, bounds) = (self.hull.aabb(), self.hull.bounds());
        let low = (0..2).any(|axis| subject.min[axis] <= bounds.min[axis]);
        low || (0..3).any(|axis| subject.max[axis] >= bounds.max[axis])
    }
}
