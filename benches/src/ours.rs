//! The library under test: the one file that names its fast interface.

use crate::scene::{Bodies, Scene};
use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::contact::{self, BodyResponse, Settings};
use ode_visual_hull::hull::{Aabb, Hull, HullData};
use std::sync::Arc;

/// A rig that takes masks and publishes frames, as a program would have it.
#[derive(Debug)]
pub struct Rig(HullData);

impl Rig {
    /// The cameras and the work volume of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let data = HullData::new();
        for camera in &scene.cameras {
            data.add_view(camera.clone()).expect("names of their own");
        }
        data.set_bounds(scene.bounds).expect("a volume");
        Self(data)
    }

    /// Masks in, a frame out: all that has to be done before the first query.
    pub fn publish(&self, masks: &[GrayImage]) -> Frame {
        for (view, mask) in masks.iter().enumerate() {
            self.0.set_mask(view, mask).expect("a mask of the camera's size");
        }
        Frame(self.0.update(0.0).expect("all views have masks"))
    }
}

/// A published frame.
#[derive(Debug, Clone)]
pub struct Frame(Arc<Hull>);

/// Points in a frame of their own, as a batch query takes them.
#[derive(Debug, Clone)]
pub struct Points(Vec<Point3<f64>>);

impl Points {
    /// The same points.
    pub fn new(points: &[Point3<f64>]) -> Self {
        Self(points.to_vec())
    }
}

/// Memory that queries use again.
#[derive(Debug, Default)]
pub struct Scratch {
    inside: Vec<bool>,
}

impl Frame {
    /// The hull itself.
    pub fn hull(&self) -> &Hull {
        &self.0
    }

    /// A box around the hull.
    pub fn aabb(&self) -> &Aabb {
        self.0.aabb()
    }

    /// Which of `points` are inside.
    pub fn inside<'s>(
        &self,
        points: &Points,
        world_from_points: &Isometry3<f64>,
        scratch: &'s mut Scratch,
    ) -> &'s [bool] {
        scratch.inside.clear();
        scratch.inside.extend(points.0.iter().map(|p| self.0.inside(&(world_from_points * p))));
        &scratch.inside
    }

    /// The paper's responses of `points`, added up.
    pub fn sum_of_responses(&self, points: &Points, _: &mut Scratch) -> Vector3<f64> {
        points.0.iter().filter_map(|p| Some(self.0.respond(p)?.w())).sum()
    }

    /// The paper's body vectors (section 5), written to `vectors`.
    pub fn body_vectors(&self, bodies: &Bodies, vectors: &mut Vec<BodyResponse>, _: &mut Scratch) {
        vectors.clear();
        let responses =
            bodies.poses.iter().map(|pose| contact::body_response(&self.0, &bodies.samples, pose));
        vectors.extend(responses);
    }

    /// The library's contacts as a simulation gets them by default; how many each body has, written to `counts`.
    pub fn contacts(&self, bodies: &Bodies, counts: &mut Vec<usize>, _: &mut Scratch) {
        let settings = Settings::default();
        counts.clear();
        counts.extend(
            bodies
                .poses
                .iter()
                .map(|pose| contact::collide(&self.0, &bodies.samples, pose, &settings, None).contacts.len()),
        );
    }

    /// How many pixels `p` is inside: the smallest Chebyshev distance to the background over the views, 0 outside.
    pub fn depth_px(&self, p: &Point3<f64>) -> u16 {
        let distance = |view: &ode_visual_hull::hull::View| {
            view.pixel(p).map_or(0, |(i, j)| view.silhouette().distance(i, j))
        };
        self.0.views().iter().map(distance).min().unwrap_or(0)
    }
}
