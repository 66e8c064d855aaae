//! The library under test. All calls of its batch functions are in this file.

use crate::scene::{Bodies, Scene};
use image::GrayImage;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::contact::{self, BodyContacts, BodyResponse, Settings};
use ode_visual_hull::hull::{Aabb, Hull, HullData, Inside, Motion, Points, Unseen, Workspace};
use ode_visual_hull::sample::Samples;
use ode_visual_hull::silhouette::PackedMask;
use std::cell::Cell;
use std::sync::Arc;

/// Seconds from frame to frame.
const FRAME: f64 = 1.0 / 60.0;

/// A rig that takes masks and publishes frames, as in an application.
#[derive(Debug)]
pub struct Rig {
    data: HullData,
    time: Cell<f64>,
}

impl Rig {
    /// The cameras and the work volume of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let data = HullData::new();
        for camera in &scene.cameras {
            data.add_view(camera.clone()).expect("names of their own");
        }
        data.set_bounds(scene.bounds).expect("a volume");
        Self { data, time: Cell::new(0.0) }
    }

    /// A rig whose views abstain where they do not see a point.
    pub fn abstaining(scene: &Scene) -> Self {
        let rig = Self::new(scene);
        rig.data.set_unseen(Unseen::ABSTAIN).expect("a policy that needs two views");
        rig
    }

    /// Prepares a frame from `masks`, one a view: everything that has to be done before the first query.
    pub fn publish(&self, masks: &[GrayImage]) -> Frame {
        for (view, mask) in masks.iter().enumerate() {
            self.data.set_mask(view, mask).expect("a mask of the camera's size");
        }
        self.update()
    }

    /// Prepares a frame from packed masks, one a view.
    pub fn publish_packed(&self, masks: &[PackedMask]) -> Frame {
        for (view, mask) in masks.iter().enumerate() {
            self.data.set_packed(view, mask).expect("a mask of the camera's size");
        }
        self.update()
    }

    /// The hull at a part of the time from the last frame to the next, for a simulation's own time.
    pub fn at(&self, motion: Motion, part: f64) -> Frame {
        Frame(self.data.in_motion(motion, self.time.get() + part * FRAME).expect("a frame"))
    }

    fn update(&self) -> Frame {
        self.time.set(self.time.get() + FRAME);
        Frame(self.data.update(self.time.get()).expect("all views have masks"))
    }
}

/// The boxes in the form that the library takes.
#[derive(Debug)]
pub struct Boxes {
    samples: Samples,
    poses: Vec<Isometry3<f64>>,
}

impl Boxes {
    /// Copies the samples and poses of `bodies`.
    pub fn new(bodies: &Bodies) -> Self {
        let Bodies { samples, poses } = bodies.clone();
        Self { samples, poses }
    }

    /// The boxes at their poses, without the escape direction of an earlier step.
    fn bodies(&self) -> Vec<contact::SampledBody<'_>> {
        let body = |pose: &Isometry3<f64>| contact::SampledBody {
            samples: &self.samples,
            hull_from_body: *pose,
            last_escape: None,
        };
        self.poses.iter().map(body).collect()
    }
}

/// A published frame.
#[derive(Debug, Clone)]
pub struct Frame(Arc<Hull>);

impl Frame {
    /// The hull itself.
    pub fn hull(&self) -> &Hull {
        &self.0
    }

    /// The frame, in which one view is overruled where all others are deeper by this many metres.
    pub fn overruling(&self, depth: f64) -> Self {
        Self(Arc::new(Hull::clone(&self.0).with_overrule_depth(Some(depth))))
    }

    /// A box around the hull.
    pub fn aabb(&self) -> &Aabb {
        self.0.aabb()
    }

    /// Which of `points` are inside.
    pub fn inside<'w>(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        workspace: &'w mut Workspace,
    ) -> Inside<'w> {
        self.0.inside_many(points, world_from_points, workspace).expect("a finite pose")
    }

    /// The sum of the z components of the paper's responses of `points`, in metres.
    pub fn rise_of_responses(&self, points: &[Point3<f64>], workspace: &mut Workspace) -> f64 {
        self.0.respond_many(points, workspace).iter().map(|response| response.w().z).sum()
    }

    /// Writes the paper's body vectors (section 5) to `vectors`, as the C functions return them.
    pub fn body_vectors(&self, boxes: &Boxes, vectors: &mut Vec<BodyResponse>) {
        contact::body_responses(&self.0, &boxes.bodies(), vectors);
    }

    /// Writes the contacts that a simulation gets by default to `contacts`, body by body.
    pub fn contacts(&self, boxes: &Boxes, contacts: &mut Vec<BodyContacts>) {
        contact::collide_many(&self.0, &boxes.bodies(), &Settings::default(), contacts);
    }

    /// The depth of `p` in pixels: the smallest Chebyshev distance to the background over the views, or 0 outside.
    pub fn depth_px(&self, p: &Point3<f64>) -> u16 {
        let distance = |view: &ode_visual_hull::hull::View| {
            view.pixel(p).map_or(0, |(i, j)| view.silhouette().distance(i, j))
        };
        self.0.views().iter().map(distance).min().unwrap_or(0)
    }
}
