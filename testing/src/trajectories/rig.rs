//! The two supports and their cameras: an upright table, and a ramp, whose box and cameras are tilted together.
//!
//! ```text
//!          c ---------.-----.          each camera looks along the top and along one side, so that
//!                     |table|          the hull of the box is the box; only the underside is open
//!                     '-----'
//! ```

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, point, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use std::sync::{Arc, LazyLock, OnceLock};

/// A support in the form of a box, with the four cameras that see it.
pub struct Rig {
    /// Name in the reference files.
    pub name: &'static str,
    /// Side lengths of the box, in metres.
    pub lengths: Vector3<f64>,
    /// Pose of the box in the world.
    pub world_from_box: Isometry3<f64>,
    /// Four pinhole cameras.
    pub cameras: Vec<Camera>,
    data: OnceLock<Arc<HullData>>,
}

/// A table of 0.5 x 0.5 x 0.4 m around the origin, seen at 2.2 mm a pixel.
pub static TABLE: LazyLock<Rig> =
    LazyLock::new(|| Rig::new("table", vector![0.5, 0.5, 0.4], Isometry3::identity(), 2.8, 0.45));

/// A ramp of 1.5 x 0.5 x 0.3 m that descends in x by 20 degrees, seen at 3.8 mm a pixel.
pub static RAMP: LazyLock<Rig> = LazyLock::new(|| {
    let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 20f64.to_radians());
    Rig::new(
        "ramp",
        vector![1.5, 0.5, 0.3],
        Isometry3::from_parts(point![0.0, 0.0, 0.5].into(), down),
        3.0,
        0.7,
    )
});

impl Rig {
    fn new(
        name: &'static str,
        lengths: Vector3<f64>,
        world_from_box: Isometry3<f64>,
        distance: f64,
        horizontal_fov: f64,
    ) -> Self {
        // Cameras are rolled by multiples of 0.2 rad, so that edges are oblique to the pixels as in a real studio.
        let cameras =
            layout::face_on(lengths, &world_from_box, distance, 0.2, (640, 480), horizontal_fov).unwrap();
        Self { name, lengths, world_from_box, cameras, data: OnceLock::new() }
    }

    /// The box as the solid that the cameras see.
    pub fn placed(&self) -> Placed {
        Placed::new(Solid::cuboid(self.lengths).unwrap(), self.world_from_box, Texture::plain([200, 60, 40]))
    }

    /// The size of a pixel at the box's centre in metres, in the camera of the finest resolution.
    pub fn pixel(&self) -> f64 {
        let centre = Point3::from(self.world_from_box.translation.vector);
        let footprint =
            |camera: &Camera| camera.project(&centre).unwrap().depth / camera.intrinsics()[(0, 0)];
        self.cameras.iter().map(footprint).fold(f64::INFINITY, f64::min)
    }

    /// The hull of the box from masks with coverage, computed once.
    pub fn hull_data(&self) -> Arc<HullData> {
        self.data.get_or_init(|| self.render()).clone()
    }

    fn render(&self) -> Arc<HullData> {
        let subject = Subject::new(vec![self.placed()]);
        let data = HullData::new();
        let reach = 0.5 * self.lengths.norm() + 0.05;
        let centre = Point3::from(self.world_from_box.translation.vector);
        let reach = Vector3::repeat(reach);
        data.set_bounds(Aabb::new(centre - reach, centre + reach).unwrap()).unwrap();
        for camera in &self.cameras {
            let view = data.add_view(camera.clone()).unwrap();
            data.set_mask(view, &coverage(camera, &subject)).unwrap();
        }
        data.update(0.0).unwrap();
        Arc::new(data)
    }

    /// Height of the box's top above its centre, in metres.
    pub fn top(&self) -> f64 {
        self.lengths.z / 2.0
    }
}
