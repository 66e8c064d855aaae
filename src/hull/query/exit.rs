//! Where a half-line from a point inside leaves the hull: the nearest exit over the views and the work volume.
//!
//! For one line the traversals of all views advance in step. The [`batch`](crate::hull::batch) traverses many lines,
//! one view after the other, and returns the same bits.

use super::interval_merge::IntervalMerge;
use crate::hull::{EdgeModel, Hull};
use nalgebra::{Point3, Vector3};

impl Hull {
    /// Metres from `p`, a point inside, along the unit `direction` to where the hull ends: the nearest exit over the
    /// views and the work volume.
    ///
    /// ```
    /// use nalgebra::{Isometry3, Point3, Vector3};
    /// use ode_visual_hull::hull::{Aabb, EdgeModel, HullData};
    /// use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, layout, silhouette};
    ///
    /// # fn main() -> ode_visual_hull::Result<()> {
    /// // A table whose top lies at z = 0.2 m, in front of four cameras that look along the top.
    /// let (sides, origin) = (Vector3::new(0.5, 0.5, 0.4), Isometry3::identity());
    /// let table = Subject::new(vec![Placed::new(Solid::cuboid(sides)?, origin, Texture::plain([200; 3]))]);
    /// let data = HullData::new();
    /// data.set_bounds(Aabb::new(Point3::new(-0.6, -0.6, -0.3), Point3::new(0.6, 0.6, 0.8))?)?;
    /// for camera in layout::face_on(sides, &origin, 2.8, 0.2, (320, 240), 0.45)? {
    ///     data.set_mask(data.add_view(camera.clone())?, &silhouette(&camera, &table))?;
    /// }
    /// let hull = data.update(0.0)?;
    ///
    /// // A point 5 cm below the top leaves the hull upwards after 5 cm, give or take a pixel of 4 mm.
    /// let (point, up) = (Point3::new(0.0, 0.0, 0.15), Vector3::z());
    /// let depth = hull.exit(&point, &up, EdgeModel::Coverage);
    /// assert!((depth - 0.05).abs() < 0.004);
    /// assert!(!hull.inside_by(&(point + up * (depth + 1e-6)), EdgeModel::Coverage));
    /// # Ok(())
    /// # }
    /// ```
    pub fn exit(&self, p: &Point3<f64>, direction: &Vector3<f64>, edge: EdgeModel) -> f64 {
        let overruled = self.overruled_at(p);
        let merge = IntervalMerge::new(self, overruled.map(|overruled| overruled.view), p, direction, edge);
        merge.map_or(0.0, |mut merge| merge.exit().t) * overruled.map_or(1.0, |overruled| overruled.share)
    }

    /// Metres from `p`, a point inside, along the unit `direction` to where the hull ends ([`Self::exit`]), at most
    /// `t_max`.
    pub fn exit_within(&self, p: &Point3<f64>, direction: &Vector3<f64>, edge: EdgeModel, t_max: f64) -> f64 {
        self.exit(p, direction, edge).min(t_max)
    }
}
