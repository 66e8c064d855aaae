//! What stands before the cameras: solids with their places and colours.

use super::solid::{Hit, Solid};
use super::texture::Texture;
use crate::camera::Ray;
use nalgebra::{Isometry3, Point3};

/// A solid at its place in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    solid: Solid,
    world_from_solid: Isometry3<f64>,
    texture: Texture,
}

impl Placed {
    /// `solid` at `world_from_solid`. With a pose that is not finite it is nowhere.
    pub fn new(solid: Solid, world_from_solid: Isometry3<f64>, paint: Texture) -> Self {
        Self { solid, world_from_solid, texture: paint }
    }

    /// The solid in its own frame.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Its pose.
    pub fn world_from_solid(&self) -> &Isometry3<f64> {
        &self.world_from_solid
    }

    /// Its colour.
    pub fn texture(&self) -> &Texture {
        &self.texture
    }

    /// The solid's origin, the centre of its bounding ball, in the world.
    pub fn centre(&self) -> Point3<f64> {
        self.world_from_solid.translation.vector.into()
    }

    /// Where `ray`, in the world, first crosses the surface ([`Solid::first_hit`]).
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.may_hit(ray).then(|| self.solid.first_hit(&self.ray_in_solid(ray)))??;
        Some(Hit { t: hit.t, normal: self.world_from_solid * hit.normal })
    }

    /// Whether `ray`, in the world, meets the solid.
    pub fn is_hit(&self, ray: &Ray) -> bool {
        self.may_hit(ray) && self.solid.first_crossing(&self.ray_in_solid(ray)).is_some()
    }

    /// Whether the world point is inside.
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

    /// Whether the ray's line meets the bounding ball, which is quicker to tell; grazing rays pass.
    fn may_hit(&self, ray: &Ray) -> bool {
        let to_centre = self.centre() - ray.origin;
        let offset = to_centre - ray.direction * to_centre.dot(&ray.direction);
        let radius = self.solid.bounding_radius() * (1.0 + 1e-9) + 1e-9;
        offset.norm_squared() <= radius * radius
    }
}

/// What the cameras see: the union of solids.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Subject {
    solids: Vec<Placed>,
}

impl Subject {
    /// The union of `solids`; none at all is a subject that no camera sees.
    pub fn new(solids: Vec<Placed>) -> Self {
        Self { solids }
    }

    /// Its solids.
    pub fn solids(&self) -> &[Placed] {
        &self.solids
    }

    /// The same subject moved by `motion` (world to world).
    pub fn transformed(&self, motion: &Isometry3<f64>) -> Self {
        let moved =
            |placed: &Placed| Placed { world_from_solid: motion * placed.world_from_solid, ..placed.clone() };
        Self { solids: self.solids.iter().map(moved).collect() }
    }

    /// Where `ray` first crosses the surface of one of the solids, and of which.
    pub fn first_hit(&self, ray: &Ray) -> Option<(Hit, &Placed)> {
        nearest_hit(self.solids.iter(), ray)
    }

    /// Whether `ray` meets the subject.
    pub fn is_hit(&self, ray: &Ray) -> bool {
        self.solids.iter().any(|placed| placed.is_hit(ray))
    }

    /// Whether the world point is inside one of the solids.
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
