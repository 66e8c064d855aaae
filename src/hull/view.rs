//! One camera of a hull with its silhouette: a pinhole and a prepared mask.

use crate::camera::{Camera, Footprint, MIN_DEPTH, Pixel, floor_pixel, frustum};
use crate::math::aabb::Aabb;
use crate::silhouette::{Border, Edge, EdgeShift, HALF_COVERAGE, MotionChain, Rect, Silhouette};
use nalgebra::{Matrix3x4, Point2, Point3, Vector2, Vector3};
use std::sync::Arc;

/// Whether one view sees a point as subject.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The point projects to a subject pixel.
    Inside,
    /// The point projects to a background pixel.
    Outside,
    /// The point lies behind the camera or outside the image, or the view abstains because its lens does not see it.
    Unseen,
}

/// Where the edge of a silhouette lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeModel {
    /// At the borders of its pixels, as in the paper.
    Pixel,
    /// Where bilinear coverage crosses one half; for a mask without coverage equal to `Pixel`.
    Coverage,
}

/// A pinhole camera and its silhouette. Cheap to clone.
#[derive(Debug, Clone)]
pub struct View {
    camera: Arc<Camera>,
    projection: Matrix3x4<f64>,
    silhouette: Arc<Silhouette>,
    field_of_view: Option<Arc<Silhouette>>,
    enabled: bool,
    time: Option<f64>,
    /// The motions of its masks up to the latest, and how many parts of the latest motion the silhouette lies before it.
    motion: Option<(Arc<MotionChain>, f64)>,
    centre: Point3<f64>,
    /// Holds the whole silhouette, by either edge model.
    rect: Rect,
    planes: [Vector3<f64>; 4],
    footprint: Footprint,
}

impl View {
    /// A view of `camera` as a pinhole. Its lens is ignored: pass the pinhole and the mask of an
    /// [`Undistortion`](crate::silhouette::Undistortion) for a camera that has one.
    ///
    /// `field_of_view` is the part of the image that the real lens saw; `None` stands for all of it. Outside that part,
    /// `silhouette` has to be background if its border is [`Border::Background`], and subject if it is
    /// [`Border::Unknown`].
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
            motion: None,
            centre,
            rect,
            planes,
            footprint,
        }
    }

    /// This view, enabled or not. A view that is not enabled abstains.
    pub fn with_enabled(mut self, enabled: bool) -> Self {
        self.enabled = enabled;
        self
    }

    /// This view with the time, in seconds, at which its mask was taken.
    pub(super) fn with_time(mut self, time: Option<f64>) -> Self {
        self.time = time;
        self
    }

    /// This view with the motions of its masks, whose silhouette lies `back` parts of the latest motion before the latest
    /// mask; `None` where it stands still or its motion is not known.
    pub(super) fn with_motion(mut self, motion: Option<(Arc<MotionChain>, f64)>) -> Self {
        self.motion = motion;
        self
    }

    /// The motion of the silhouette's edge at `point`, an edge point; `None` where it is not known.
    pub(super) fn edge_shift(&self, point: &Point2<f64>) -> Option<EdgeShift> {
        let (chain, back) = self.motion()?;
        chain.edge_shift(point, back)
    }

    /// The motions of its masks up to the latest, and how many parts of the latest motion the silhouette lies before it.
    pub(super) fn motion(&self) -> Option<(&MotionChain, f64)> {
        self.motion.as_ref().map(|(chain, back)| (&**chain, *back))
    }

    /// Whether the motion of the silhouette is known.
    pub(super) fn has_motion(&self) -> bool {
        self.motion.is_some()
    }

    /// When the mask was taken, in seconds; `None` where that is not known.
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

    /// Whether the view takes part in queries: it is neither disabled nor late.
    pub fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// The part of the image that the real lens saw, as its subject pixels; `None` where that is the whole image.
    pub fn field_of_view(&self) -> Option<&Silhouette> {
        self.field_of_view.as_deref()
    }

    /// The field of view, if the pixels that the lens did not see are unknown: with [`Border::Unknown`]. With
    /// [`Border::Background`] they are background of the mask, and no separate test is needed.
    pub(super) fn blind_spots(&self) -> Option<&Silhouette> {
        self.field_of_view().filter(|_| self.silhouette.border() == Border::Unknown)
    }

    /// The projection matrix from the world to the image; its third row gives the depth in metres.
    pub(super) fn projection(&self) -> &Matrix3x4<f64> {
        &self.projection
    }

    /// Homogeneous image coordinates of `p`: `(u depth, v depth, depth)`.
    pub(super) fn homogeneous(&self, p: &Point3<f64>) -> Vector3<f64> {
        self.projection * p.to_homogeneous()
    }

    /// The change of homogeneous image coordinates per metre along the unit `direction`.
    pub(super) fn homogeneous_direction(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.projection.fixed_columns::<3>(0) * direction
    }

    /// By how many pixels the image of a point at `image`, `depth` metres in front of the camera, moves along the unit image
    /// direction `normal` for each metre that the point moves along x, y and z.
    pub(super) fn image_motion_along(
        &self,
        depth: f64,
        image: &Point2<f64>,
        normal: &Vector2<f64>,
    ) -> Vector3<f64> {
        let row = |k: usize| self.projection.fixed_view::<1, 3>(k, 0).transpose();
        let along = (row(0) - row(2) * image.x) * normal.x + (row(1) - row(2) * image.y) * normal.y;
        along / depth
    }

    /// The image position and depth of `p`; `None` behind the camera. The position may lie outside the image.
    pub fn project(&self, p: &Point3<f64>) -> Option<Pixel> {
        let h = self.homogeneous(p);
        (h.z > MIN_DEPTH).then(|| Pixel { u: h.x / h.z, v: h.y / h.z, depth: h.z })
    }

    /// The pixel that `p` projects to, if the view sees it.
    pub fn pixel(&self, p: &Point3<f64>) -> Option<(i32, i32)> {
        let pixel = self.project(p)?;
        let (i, j) = floor_pixel(pixel.u, pixel.v);
        self.sees(i, j).then_some((i, j))
    }

    /// Whether pixel `(i, j)` lies in the image and in the real lens's field of view.
    pub fn sees(&self, i: i32, j: i32) -> bool {
        self.silhouette.image().contains(i, j)
            && self.field_of_view().is_none_or(|field_of_view| field_of_view.is_subject(i, j))
    }

    /// Whether pixel `(i, j)` lies in the image and the view does not abstain on it for being out of the lens's sight.
    pub(super) fn judges(&self, i: i32, j: i32) -> bool {
        self.silhouette.image().contains(i, j)
            && self.blind_spots().is_none_or(|field_of_view| field_of_view.is_subject(i, j))
    }

    /// Whether pixel `(i, j)` lies in the rectangle that holds the silhouette by either edge model.
    pub(super) fn may_contain_subject(&self, (i, j): (i32, i32)) -> bool {
        self.rect.contains(i, j)
    }

    /// The view's verdict on `p`, by the edge model `edge`. `rectangle_first` tests the silhouette's rectangle before
    /// its pixels, which changes the speed but not the result.
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

    /// Whether any part of `volume` lies in front of the camera and projects into the image.
    pub(super) fn sees_some_of(&self, volume: &Aabb) -> bool {
        let sides = frustum::planes(&self.projection, &self.silhouette.image());
        !frustum::clipped_box(volume, &self.camera, &sides).is_empty()
    }

    /// Whether the camera sees all of `volume`, which is convex: it does if it sees the corners.
    pub(super) fn sees_all_of(&self, volume: &Aabb) -> bool {
        self.field_of_view.is_none() && volume.corners().iter().all(|corner| self.pixel(corner).is_some())
    }

    /// Whether `p`, a point in front of the camera, lies outside the frustum of the silhouette's rectangle.
    pub(super) fn outside_frustum(&self, p: &Point3<f64>) -> bool {
        let offset = p - self.centre;
        // A cull must not depend on rounding: a point near the frustum's side is left to the mask.
        let slack = 1e-9 * offset.norm();
        self.planes.iter().any(|outward| outward.dot(&offset) > slack)
    }

    /// A box around the part of `bounds` in the frustum of the silhouette's rectangle.
    pub(super) fn frustum_box(&self, bounds: &Aabb) -> Aabb {
        if self.silhouette.rect().is_empty() {
            return Aabb::EMPTY;
        }
        frustum::clipped_box(bounds, &self.camera, &self.planes)
    }

    /// The outward unit normal, in the world, of the plane through the camera's centre and the image line through
    /// `point` (pixels) with image normal `normal` (paper, section 4.2: "backprojecting the 2D silhouette normal").
    pub fn backproject_normal(&self, point: &Point2<f64>, normal: &Vector2<f64>) -> Vector3<f64> {
        frustum::backproject_normal(&self.projection, point, normal)
    }

    /// The outward unit normal, in the world, of the plane through the camera's centre and a silhouette edge.
    pub(super) fn backproject_edge(&self, edge: &Edge) -> Vector3<f64> {
        self.backproject_normal(&edge.point, &edge.normal)
    }

    /// The metres that one pixel covers, by depth.
    pub(super) fn footprint(&self) -> &Footprint {
        &self.footprint
    }
}
