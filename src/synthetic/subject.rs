//! The subject in front of the cameras: solids with poses and colours.

use super::solid::{Hit, Solid};
use super::texture::Texture;
use crate::camera::Ray;
use nalgebra::{Isometry3, Point3};

/// A solid with its pose in the world and its colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    solid: Solid,
    world_from_solid: Isometry3<f64>,
    texture: Texture,
}

impl Placed {
    /// `solid` at the pose `world_from_solid`. With a pose that is not finite nothing meets it.
    pub fn new(solid: Solid, world_from_solid: Isometry3<f64>, texture: Texture) -> Self {
        Self { solid, world_from_solid, texture }
    }

    /// The solid in its own frame.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// The solid's pose.
    pub fn world_from_solid(&self) -> &Isometry3<f64> {
        &self.world_from_solid
    }

    /// The solid's colour.
    pub fn texture(&self) -> &Texture {
        &self.texture
    }

    /// The solid's origin, the centre of its bounding ball, in the world.
    pub fn centre(&self) -> Point3<f64> {
        self.world_from_solid.translation.vector.into()
    }

    /// The point where `ray`, in the world, first crosses the surface ([`Solid::first_hit`]).
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.may_hit(ray).then(|| self.solid.first_hit(&self.ray_in_solid(ray)))??;
        Some(Hit { t: hit.t, normal: self.world_from_solid * hit.normal })
    }

    /// Whether `ray`, in the world, meets the solid.
    pub fn is_hit(&self, ray: &Ray) -> bool {
        self.may_hit(ray) && self.solid.first_crossing(&self.ray_in_solid(ray)).is_some()
    }

    /// Whether a point in the world is inside the solid.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.solid.contains(&self.world_from_solid.inverse_transform_point(point))
    }

    /// `ray` in the solid's frame.
    pub(super) fn ray_in_solid(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.world_from_solid.inverse_transform_point(&ray.origin),
            direction: self.world_from_solid.inverse_transform_vector(&ray.direction),
        }
    }

    /// Whether the ray's line meets the bounding ball: a cheap test, which grazing rays pass.
    fn may_hit(&self, ray: &Ray) -> bool {
        let to_centre = self.centre() - ray.origin;
        let offset = to_centre - ray.direction * to_centre.dot(&ray.direction);
        let radius = self.solid.bounding_radius() * (1.0 + 1e-9) + 1e-9;
        offset.norm_squared() <= radius * radius
    }
}

/// The subject that the cameras see: a union of solids.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Subject {
    solids: Vec<Placed>,
}

impl Subject {
    /// The union of `solids`; an empty list is a subject that no camera sees.
    pub fn new(solids: Vec<Placed>) -> Self {
        Self { solids }
    }

    /// The solids of the union.
    pub fn solids(&self) -> &[Placed] {
        &self.solids
    }

    /// This subject moved by `motion` (world to world).
    pub fn transformed(&self, motion: &Isometry3<f64>) -> Self {
        let moved =
            |placed: &Placed| Placed { world_from_solid: motion * placed.world_from_solid, ..placed.clone() };
        Self { solids: self.solids.iter().map(moved).collect() }
    }

    /// The point where `ray` first crosses the surface of one of the solids, and that solid.
    pub fn first_hit(&self, ray: &Ray) -> Option<(Hit, &Placed)> {
        nearest_hit(self.solids.iter(), ray)
    }

    /// Whether `ray` meets the subject.
    pub fn is_hit(&self, ray: &Ray) -> bool {
        self.solids.iter().any(|placed| placed.is_hit(ray))
    }

    /// Whether a point in the world is inside one of the solids.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.solids.iter().any(|placed| placed.contains(point))
    }
}

/// The nearest of the hits of `ray` on `solids`.
pub(super) fn nearest_hit<'s>(
    solids: impl Iterator<Item = &'s Placed>,
    ray: &Ray,
) -> Option<(Hit, &'s Placed)> {
    solids
        .filter_map(|placed| Some((placed.first_hit(ray)?, placed)))
        .min_by(|(a, _), (b, _)| a.t.total_cmp(&b.t))
}
