//! What a picture is drawn from: the silhouettes and images of one moment, bodies, floor and light.

mod mesh;
mod obstacle;
mod view;

pub use mesh::{Mesh, Vertex};
pub use view::SceneView;

use image::RgbImage;
use nalgebra::Vector3;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Hull, View};
use ode_visual_hull::silhouette::Undistortion;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::Drawn;
use rayon::prelude::*;
use std::sync::Arc;

/// The real cameras of a capture, and the undistortion of their lenses.
#[derive(Debug)]
pub struct RealCameras {
    cameras: Vec<Camera>,
    /// `None` for a pinhole.
    undistortions: Vec<Option<Undistortion>>,
}

/// The real subject and the virtual bodies at one moment, in world coordinates and metres. World z is up.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The hull of the subject.
    pub hull: Hull,
    /// The real cameras that see the subject: the hull's views that are enabled.
    pub views: Vec<SceneView>,
    /// The virtual bodies.
    pub bodies: Vec<Drawn>,
    /// The height of the floor; `None` draws none.
    pub floor: Option<f64>,
    /// The unit direction in which the light falls.
    pub light: Vector3<f64>,
}

impl Scene {
    /// The scene without its view `index`: neither its silhouette nor its colours count.
    pub fn without_view(&self, index: usize) -> Self {
        let mut scene = self.clone();
        let left_out = scene.views.remove(index);
        let keeps = |view: &View| view.is_enabled() && view.name() != left_out.camera().name();
        let views = self.hull.views().iter().map(|view| view.clone().with_enabled(keeps(view))).collect();
        scene.hull = Hull::new(views, *self.hull.bounds(), self.hull.unseen(), self.hull.time());
        scene
    }

    /// The scene in which view `index` gives the subject no colours; its silhouette still counts.
    pub fn without_colours_of(&self, index: usize) -> Self {
        let mut scene = self.clone();
        scene.views[index].leave_out_colours();
        scene
    }
}

impl RealCameras {
    /// Prepares the undistortion of each of `cameras`, in the order of the hull's views.
    pub fn new(cameras: &[Camera]) -> Self {
        Self { cameras: cameras.to_vec(), undistortions: cameras.iter().map(Undistortion::new).collect() }
    }

    /// The cameras, with their lenses.
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// Camera `view` as a pinhole.
    pub fn pinhole(&self, view: usize) -> &Camera {
        self.undistortions[view].as_ref().map_or(&self.cameras[view], Undistortion::pinhole)
    }

    /// The scene of `hull` with the `images` of the same moment, one for each camera; `None` for a camera whose image is
    /// missing: its silhouette counts, its colours do not. It has no bodies, a floor at z = 0 and light from above.
    ///
    /// # Errors
    /// Fewer or more images than cameras, none at all, or one of another size than its camera; a hull of other cameras,
    /// one without views that are enabled, or an empty one.
    pub fn scene(&self, hull: &Hull, images: Vec<Option<impl Into<Arc<RgbImage>>>>) -> Result<Scene> {
        if let Some(why) = hull.empty_reason() {
            return Err(Error::argument(format!(
                "hull: expected a subject, found an empty hull ({why:?}); check the masks and the work volume"
            )));
        }
        let scene = self.any_scene(hull, images)?;
        if scene.views.iter().all(|view| view.photo().is_none()) {
            return Err(Error::argument(format!(
                "images: expected one of at least one of the cameras {}, found none; draw the shape alone with the method hull, or \
                 record images",
                self.cameras.iter().map(Camera::name).collect::<Vec<_>>().join(", ")
            )));
        }
        Ok(scene)
    }

    /// As [`scene`](Self::scene), but there may be no subject, as before a person enters, and all images may be missing.
    ///
    /// # Errors
    /// As [`scene`](Self::scene), except those about an empty hull and images that are all missing.
    pub fn any_scene(&self, hull: &Hull, images: Vec<Option<impl Into<Arc<RgbImage>>>>) -> Result<Scene> {
        let images: Vec<_> = images.into_iter().map(|image| image.map(Into::into)).collect();
        self.check(hull, images.len())?;
        let enabled = images.into_par_iter().enumerate().filter(|(view, _)| hull.views()[*view].is_enabled());
        let view = |(view, photo): (usize, Option<Arc<RgbImage>>)| {
            SceneView::new(&hull.views()[view], photo, self.undistortions[view].as_ref(), hull.unseen())
        };
        let views: Vec<_> = enabled.map(view).collect::<Result<Vec<_>>>()?;
        Ok(Scene {
            hull: hull.clone(),
            views,
            bodies: Vec::new(),
            floor: Some(0.0),
            light: Vector3::new(0.25, 0.15, -1.0).normalize(),
        })
    }

    fn check(&self, hull: &Hull, image_count: usize) -> Result<()> {
        let count = self.cameras.len();
        if hull.views().len() != count || image_count != count {
            return Err(Error::argument(format!(
                "scene: expected a hull and images of {count} cameras, found {} views and {} images",
                hull.views().len(),
                image_count
            )));
        }
        for (view, camera) in self.cameras.iter().enumerate() {
            let (expected, found) = (self.pinhole(view).size(), hull.views()[view].camera().size());
            if hull.views()[view].name() != camera.name() || expected != found {
                return Err(Error::view(
                    camera.name(),
                    format!(
                        "expected a view of it in the hull, {} x {} pixels as a pinhole, found {} of {} x {}",
                        expected.0,
                        expected.1,
                        hull.views()[view].name(),
                        found.0,
                        found.1
                    ),
                ));
            }
        }
        Ok(())
    }
}
