//! One real camera of a scene: a pinhole, the distances of its silhouette, and its colours.

use image::RgbImage;
use nalgebra::{Matrix3x4, Point3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Unseen, View};
use ode_visual_hull::silhouette::{Rect, SignedDistance, Undistortion};
use ode_visual_hull::{Error, Result};
use std::sync::Arc;

/// Pixels around the silhouette whose distances are known.
const MARGIN: i32 = 2;

/// One real camera of a scene. What it saw is undistorted: the camera is a pinhole.
#[derive(Debug, Clone)]
pub struct SceneView {
    camera: Camera,
    projection: Matrix3x4<f64>,
    /// Holds all subject pixels.
    rect: Rect,
    /// Signed distances from the silhouette's edge around `rect`, or in the whole image if the view abstains outside it.
    distance: SignedDistance,
    /// The image as the pinhole sees it; `None` where it is missing.
    photo: Option<Arc<RgbImage>>,
    uses_colour: bool,
}

impl SceneView {
    pub(super) fn new(
        view: &View,
        photo: Option<Arc<RgbImage>>,
        undistortion: Option<&Undistortion>,
        unseen: Unseen,
    ) -> Result<Self> {
        let silhouette = view.silhouette();
        let known = match unseen {
            Unseen::Outside => silhouette.rect().grown(MARGIN),
            Unseen::Abstain { .. } => silhouette.image(),
        };
        let photo = photo.map(|photo| undistorted(view, photo, undistortion)).transpose()?;
        Ok(Self {
            camera: view.camera().clone(),
            projection: view.camera().projection_matrix(),
            rect: silhouette.rect(),
            distance: silhouette.signed_distance_near_edge(&known),
            uses_colour: photo.is_some(),
            photo,
        })
    }

    /// The pinhole camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Its projection matrix, from the world to pixels.
    pub fn projection(&self) -> &Matrix3x4<f64> {
        &self.projection
    }

    /// Its centre in the world.
    pub fn centre(&self) -> Point3<f64> {
        self.camera.centre()
    }

    /// The smallest rectangle of pixels that holds the silhouette.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// Signed distances from the silhouette's edge in pixels, negative inside.
    pub fn distance(&self) -> &SignedDistance {
        &self.distance
    }

    /// The image as the pinhole sees it; `None` where it is missing.
    pub fn photo(&self) -> Option<&RgbImage> {
        self.photo.as_deref()
    }

    /// The image, if the subject may get its colours from it.
    pub fn colours(&self) -> Option<&RgbImage> {
        self.photo().filter(|_| self.uses_colour)
    }

    /// Whether pixel `(i, j)` belongs to the silhouette.
    pub fn is_subject(&self, i: i32, j: i32) -> bool {
        self.rect.contains(i, j) && self.distance.at(i, j) < 0.0
    }

    pub(super) fn leave_out_colours(&mut self) {
        self.uses_colour = false;
    }
}

/// `photo` as the pinhole of `view` sees it.
fn undistorted(
    view: &View,
    photo: Arc<RgbImage>,
    undistortion: Option<&Undistortion>,
) -> Result<Arc<RgbImage>> {
    let (width, height) = view.camera().size();
    let Some(undistortion) = undistortion else {
        if photo.dimensions() == (width, height) {
            return Ok(photo);
        }
        return Err(Error::view(
            view.name(),
            format!(
                "expected an image of {width} x {height} pixels as its masks have, found {} x {}; use images of the calibrated \
                 size",
                photo.width(),
                photo.height()
            ),
        ));
    };
    let mut pinhole_image = RgbImage::default();
    undistortion.apply_to_image(&photo, &Rect::of_image(width, height), &mut pinhole_image)?;
    Ok(pinhole_image.into())
}
