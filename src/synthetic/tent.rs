//! How high the visual hull stands above a flat top.
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

/// Columns above the top in which the hull's height is measured, along each side; odd, so that one is in the middle.
const COLUMNS: usize = 21;

/// Heights are found by halving the interval so often.
const HALVINGS: usize = 40;

/// The hull above a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Tent {
    /// Its height above the middle of the top, in metres.
    pub middle: f64,
    /// Its largest height above the top, in metres.
    pub highest: f64,
    /// The cameras that see all of the top and so bound it, by their positions.
    pub cameras: Vec<usize>,
}

impl Tent {
    /// The hull above a cube with edges of `side` metres along the world's axes, the middle of whose upper face is
    /// `top`, as `cameras` see it by exact rays: no pixels, no masks. Cameras that do not see the whole top are left
    /// out. Where too few are left to bound it, the heights are 10 sides.
    ///
    /// # Errors
    /// A side that is not positive and finite.
    pub fn above(cameras: &[Camera], top: Point3<f64>, side: f64) -> Result<Self> {
        let cube = Solid::cuboid(Vector3::repeat(side))?;
        let pose = Isometry3::translation(top.x, top.y, top.z - 0.5 * side);
        let cube = Subject::new(vec![Placed::new(cube, pose, Texture::plain([0; 3]))]);
        let at = |x: f64, y: f64, height: f64| top + Vector3::new(x * side, y * side, height);
        let places = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5), (0.0, 0.0)];
        let sees_top = |camera: &Camera| places.iter().all(|&(x, y)| camera.sees(&at(x, y, 0.0)));
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
        // Columns stand off the edges by half their spacing.
        let place = |k: usize| (k as f64 + 0.5) / COLUMNS as f64 - 0.5;
        let columns = (0..COLUMNS * COLUMNS).map(|k| height(place(k % COLUMNS), place(k / COLUMNS)));
        Ok(Self { middle: height(0.0, 0.0), highest: columns.fold(0.0, f64::max), cameras: seeing })
    }
}
