//! One camera of a hull with its silhouette: a pinhole and a prepared mask.

use crate::camera::{Camera, Footprint, MIN_DEPTH, Pixel, floor_pixel, frustum};
use crate::math::aabb::Aabb;
use crate::silhouette::{Border, Edge, HALF_COVERAGE, Rect, Silhouette};
use nalgebra::{Matrix3x4, Point2, Point3, Vector2, Vector3};
use std::sync::Arc;

/// What one view says of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// It projects to a subject pixel.
    Inside,
    /// It projects to a background pixel.
    Outside,
    /// It lies behind the camera or outside the image.
    Unseen,
}

/// Where a silhouette's edge is taken to lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeModel {
    /// At the sides of its pixels, as the inside test has it.
    Pixel,
    /// Where bilinear coverage crosses one half; for a mask without coverage the same as `Pixel`.
    Coverage,
}

/// A pinhole camera and the silhouette it saw. Cheap to clone.
#[derive(Debug, Clone)]
pub struct View {
    camera: Arc<Camera>,
    projection: Matrix3x4<f64>,
    silhouette: Arc<Silhouette>,
    field_of_view: Option<Arc<Silhouette>>,
    enabled: bool,
    time: Option<f64>,
    centre: Point3<f64>,
    /// Holds every point of the silhouette, whichever way its edge is taken.
    rect: Rect,
    planes: [Vector3<f64>; 4],
    footprint: Footprint,
}

impl View {
    /// A view of `camera`, whose distortion is ignored: give it the camera and mask of
    /// [`Undistortion`](crate::silhouette::Undistortion) for a lens that has any. `field_of_view` is the part of the
    /// image that the real lens saw, where that is not all of it; beyond it `silhouette` has to be what it is beyond the
    /// image: background, or subject with an open border.
    pub fn new(
        camera: Arc<Camera>,
        silhouette: Arc<Silhouette>,
        field_of_view: Option<Arc<Silhouette>>,
    ) -> Self {
        let projection = camera.projection_matrix();
        // With coverage the edge may lie up to half a pixel beyond the subject's last pixel.
        let rect = silhouette.rect().grown(i32::from(silhouette.has_coverage()));
        let planes = frustum::planes(&projection, &rect);
        let centre = camera.centre();
        let footprint = Footprint::new(camera.intrinsics());
        Self {
            camera,
            projection,
            silhouette,
            field_of_view,
            enabled: true,
            time: None,
            centre,
            rect,
            planes,
            footprint,
        }
    }

    /// The view taken out, so that it abstains, or put back.
    pub fn with_enabled(mut self, enabled: bool) -> Self {
        self.enabled = enabled;
        self
    }

    /// This view with a mask that was taken at `time` seconds.
    pub(super) fn with_time(mut self, time: Option<f64>) -> Self {
        self.time = time;
        self
    }

    /// When its mask was taken, in seconds; `None` where that is not known.
    pub fn time(&self) -> Option<f64> {
        self.time
    }

    /// The pinhole camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The camera's name.
    pub fn name(&self) -> &str {
        self.camera.name()
    }

    /// The prepared mask.
    pub fn silhouette(&self) -> &Silhouette {
        &self.silhouette
    }

    pub(super) fn into_silhouette(self) -> Arc<Silhouette> {
        self.silhouette
    }

    /// Whether it takes part.
    pub fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// The part of the image that the real lens saw, where that is not all of it.
    pub(crate) fn field_of_view(&self) -> Option<&Silhouette> {
        self.field_of_view.as_deref()
    }

    /// The field of view, where what the lens did not see is not background: with an open border. Else the mask says
    /// all.
    pub(super) fn blind_spots(&self) -> Option<&Silhouette> {
        self.field_of_view().filter(|_| self.silhouette.border() == Border::Unknown)
    }

    /// World to image, row-major; its third row gives the depth in metres.
    pub(super) fn projection(&self) -> &Matrix3x4<f64> {
        &self.projection
    }

    /// Homogeneous image coordinates of `p`: `(u depth, v depth, depth)`.
    pub(super) fn homogeneous(&self, p: &Point3<f64>) -> Vector3<f64> {
        self.projection * p.to_homogeneous()
    }

    /// How the homogeneous image coordinates change along `direction`.
    pub(super) fn homogeneous_direction(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.projection.fixed_columns::<3>(0) * direction
    }

    /// Where `p` appears; `None` behind the camera. The image's borders are not looked at.
    pub fn project(&self, p: &Point3<f64>) -> Option<Pixel> {
        let h = self.homogeneous(p);
        (h.z > MIN_DEPTH).then(|| Pixel { u: h.x / h.z, v: h.y / h.z, depth: h.z })
    }

    /// The pixel that `p` lies in, when the view sees it.
    pub fn pixel(&self, p: &Point3<f64>) -> Option<(i32, i32)> {
        let pixel = self.project(p)?;
        let (i, j) = floor_pixel(pixel.u, pixel.v);
        self.sees(i, j).then_some((i, j))
    }

    /// Whether pixel `(i, j)` exists and was in the real lens's sight.
    pub(crate) fn sees(&self, i: i32, j: i32) -> bool {
        self.silhouette.image().contains(i, j)
            && self.field_of_view().is_none_or(|seen| seen.is_subject(i, j))
    }

    /// Whether pixel `(i, j)` exists, and is none that the lens did not see and on which the view therefore abstains.
    pub(super) fn judges(&self, i: i32, j: i32) -> bool {
        self.silhouette.image().contains(i, j) && self.blind_spots().is_none_or(|seen| seen.is_subject(i, j))
    }

    /// Whether pixel `(i, j)` lies where subject may be, whichever way its edge is taken.
    pub(super) fn may_contain_subject(&self, (i, j): (i32, i32)) -> bool {
        self.rect.contains(i, j)
    }

    /// What the view says of `p`, with the silhouette's edge taken by `edge`. The answer is the same whether the
    /// silhouette's rectangle is asked first or not.
    pub(super) fn verdict(&self, p: &Point3<f64>, edge: EdgeModel, rectangle_first: bool) -> Verdict {
        let Some(pixel) = self.project(p) else { return Verdict::Unseen };
        let (i, j) = floor_pixel(pixel.u, pixel.v);
        let inside = if !self.judges(i, j) {
            return Verdict::Unseen;
        } else if rectangle_first && !self.rect.contains(i, j) {
            false
        } else if edge == EdgeModel::Coverage && self.silhouette.has_coverage() {
            self.silhouette.coverage(pixel.u, pixel.v) >= HALF_COVERAGE
        } else {
            self.silhouette.is_subject(i, j)
        };
        if inside { Verdict::Inside } else { Verdict::Outside }
    }

    /// Whether any part of `volume` is in sight.
    pub(super) fn sees_some_of(&self, volume: &Aabb) -> bool {
        let sides = frustum::planes(&self.projection, &self.silhouette.image());
        !frustum::clipped_box(volume, &self.camera, &sides).is_empty()
    }

    /// Whether the whole of `volume` is in sight.
    pub(super) fn sees_all_of(&self, volume: &Aabb) -> bool {
        self.field_of_view.is_none() && volume.corners().iter().all(|corner| self.pixel(corner).is_some())
    }

    /// Whether `p` lies outside the frustum of the silhouette's rectangle, for a point in front of the camera.
    pub(super) fn outside_frustum(&self, p: &Point3<f64>) -> bool {
        let offset = p - self.centre;
        // A cull must not decide what rounding could: a point on the rectangle's rim is left to the mask.
        let slack = 1e-9 * offset.norm();
        self.planes.iter().any(|outward| outward.dot(&offset) > slack)
    }

    /// The box of the silhouette rectangle's frustum inside `bounds`.
    pub(super) fn frustum_box(&self, bounds: &Aabb) -> Aabb {
        if self.silhouette.rect().is_empty() {
            return Aabb::EMPTY;
        }
        frustum::clipped_box(bounds, &self.camera, &self.planes)
    }

    /// The outward normal in the world of the plane through the camera's centre and the image line through `point`
    /// with image normal `normal` (paper, section 4.2: "backprojecting the 2D silhouette normal").
    pub fn backproject_normal(&self, point: &Point2<f64>, normal: &Vector2<f64>) -> Vector3<f64> {
        frustum::backproject_normal(&self.projection, point, normal)
    }

    /// The same for an edge of the silhouette.
    pub(super) fn backproject_edge(&self, edge: &Edge) -> Vector3<f64> {
        self.backproject_normal(&edge.point, &edge.normal)
    }

    /// Metres that one pixel covers at any depth.
    pub(super) fn footprint(&self) -> &Footprint {
        &self.footprint
    }
}
