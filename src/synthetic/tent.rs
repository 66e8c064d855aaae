//! The height of the visual hull above a flat top.
//!
//! ```text
//!   camera o
//!             ' - .        .-'.          the ray that grazes the far edge of the top
//!                   ' -.-'   : height    bounds the hull above it
//!                   .-'' - . :
//!                  +=========='+
//! ```

use super::{Placed, Solid, Subject, Texture};
use crate::Result;
use crate::camera::{Camera, Ray};
use nalgebra::{Isometry3, Point3, Vector3};

/// Columns above the top along each side in which the hull's height is measured; odd, so that one is in the middle.
const COLUMNS: usize = 21;

/// Bisection steps per height.
const HALVINGS: usize = 40;

/// The part of a hull above a table top.
#[derive(Debug, Clone, PartialEq)]
pub struct Tent {
    /// The height above the middle of the top, in metres.
    pub middle: f64,
    /// The largest height above the top, in metres.
    pub highest: f64,
    /// The indices of the cameras that see the whole top and so bound the hull.
    pub cameras: Vec<usize>,
}

impl Tent {
    /// The hull above a cube with edges of `side` metres along the world's axes and `top` as the centre of its upper
    /// face, computed from exact rays of `cameras` without pixels or masks. Cameras that do not see the whole top are
    /// left out. If the rest do not bound the hull, the heights are 10 sides.
    ///
    /// # Errors
    /// A side that is not positive and finite.
    pub fn above(cameras: &[Camera], top: Point3<f64>, side: f64) -> Result<Self> {
        let cube = Solid::cuboid(Vector3::repeat(side))?;
        let pose = Isometry3::translation(top.x, top.y, top.z - 0.5 * side);
        let cube = Subject::new(vec![Placed::new(cube, pose, Texture::plain([0; 3]))]);

        let at = |x: f64, y: f64, height: f64| top + Vector3::new(x * side, y * side, height);
        let sample_points = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5), (0.0, 0.0)];
        let sees_top = |camera: &Camera| sample_points.iter().all(|&(x, y)| camera.sees(&at(x, y, 0.0)));
        let seeing: Vec<usize> = (0..cameras.len()).filter(|&k| sees_top(&cameras[k])).collect();

        let centres: Vec<_> = seeing.iter().map(|&k| cameras[k].centre()).collect();
        let in_hull = |point: &Point3<f64>| {
            centres
                .iter()
                .all(|&origin| cube.is_hit(&Ray { origin, direction: (point - origin).normalize() }))
        };

        let height = |x: f64, y: f64| {
            let (mut inside, mut outside) = (0.0, 10.0 * side);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                if in_hull(&at(x, y, middle)) { inside = middle } else { outside = middle }
            }
            outside
        };

        // The outermost columns are half their spacing from the edges.
        let position = |k: usize| (k as f64 + 0.5) / COLUMNS as f64 - 0.5;
        let columns = (0..COLUMNS * COLUMNS).map(|k| height(position(k % COLUMNS), position(k / COLUMNS)));
        Ok(Self { middle: height(0.0, 0.0), highest: columns.fold(0.0, f64::max), cameras: seeing })
    }
}
