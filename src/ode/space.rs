//! Spaces: groups of geoms for the broad phase, which spares most pairs an exact test.

mod view;

use nalgebra::{Point3, Vector3};
use ode_sys::{
    dGeomDestroy, dHashSpaceCreate, dHashSpaceSetLevels, dQuadTreeSpaceCreate, dSAP_AXES_XYZ, dSAP_AXES_XZY,
    dSAP_AXES_YXZ, dSAP_AXES_YZX, dSAP_AXES_ZXY, dSAP_AXES_ZYX, dSimpleSpaceCreate, dSpaceDestroy, dSpaceID,
    dSweepAndPruneSpaceCreate,
};

use super::arena::{GeomId, Key, SpaceId};
use super::hull::clear_samples;
use super::world::World;
use super::{check, convert};
use crate::{Error, Result};

pub use view::Space;

/// The broad phase of a space: how it finds the pairs that may touch. All kinds find the same pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SpaceKind {
    /// Compares every geom with every other, for a few geoms.
    Simple,
    /// Hashes geoms into grid cells of 2^`min_level` to 2^`max_level` metres. Larger geoms are compared with all.
    Hash {
        /// The binary logarithm of the smallest cell size in metres, at least -5.
        min_level: i32,
        /// The binary logarithm of the largest cell size in metres, from `min_level` to 30.
        max_level: i32,
    },
    /// Sorts geoms along the axes, for many geoms that move little between two steps.
    SweepAndPrune(SweepAxes),
    /// Divides a rectangle of the x-y plane into quarters again and again, for wide, flat scenes. Geoms outside it are
    /// compared with all.
    QuadTree {
        /// The rectangle's centre.
        center: Point3<f64>,
        /// Half the rectangle's size along x and y; z is ignored.
        extents: Vector3<f64>,
        /// The number of divisions, 1 to 8.
        depth: u32,
    },
}

/// The order of axes along which a [`SpaceKind::SweepAndPrune`] sorts. Begin with the axis along which the geoms are
/// spread most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[allow(missing_docs, reason = "the names are the axes")]
pub enum SweepAxes {
    #[default]
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    Zxy,
    Zyx,
}

impl Default for SpaceKind {
    /// A hash space with ODE's default cell sizes, 1/8 m to 1024 m.
    fn default() -> Self {
        Self::Hash { min_level: -3, max_level: 10 }
    }
}

/// A space that a world owns.
#[derive(Debug)]
pub(super) struct SpaceRecord {
    pub(super) raw: dSpaceID,
    pub(super) parent: Option<Key>,
    pub(super) kind: SpaceKind,
}

impl SpaceKind {
    /// Refuses parameters that are out of range.
    pub(super) fn checked(self) -> Result<Self> {
        match self {
            Self::Simple | Self::SweepAndPrune(_) => {}
            Self::Hash { min_level, max_level } => {
                // With smaller cells the largest coordinate would overflow ODE's cell numbers, and ODE would abort.
                if min_level < -5 || max_level < min_level || max_level > 30 {
                    return Err(Error::argument(format!(
                        "hash space: expected levels with -5 <= min <= max <= 30, found {min_level} and {max_level}"
                    )));
                }
            }
            Self::QuadTree { center, extents, depth } => {
                check::point("centre of the quadtree space", &center)?;
                for extent in extents.xy().iter() {
                    check::length("extent of the quadtree space", *extent)?;
                }
                if !(1..=8).contains(&depth) {
                    return Err(Error::argument(format!(
                        "depth of the quadtree space: expected 1 to 8, found {depth}"
                    )));
                }
            }
        }

        Ok(self)
    }

    /// Creates an empty space inside `parent`.
    ///
    /// # Safety
    ///
    /// ODE is open, [`checked`](Self::checked) has accepted `self`, and `parent` is null or a living space.
    pub(super) unsafe fn create(self, parent: dSpaceID) -> dSpaceID {
        // SAFETY: the caller guarantees a living parent and checked parameters; ODE copies the vectors.
        unsafe {
            match self {
                Self::Simple => dSimpleSpaceCreate(parent),
                Self::Hash { min_level, max_level } => {
                    let space = dHashSpaceCreate(parent);
                    dHashSpaceSetLevels(space, min_level, max_level);
                    space
                }
                Self::SweepAndPrune(axes) => dSweepAndPruneSpaceCreate(parent, axes.order() as i32),
                Self::QuadTree { center, extents, depth } => {
                    let (center, extents) =
                        (convert::ode_vector(&center.coords), convert::ode_vector(&extents));
                    dQuadTreeSpaceCreate(parent, center.as_ptr(), extents.as_ptr(), depth as i32)
                }
            }
        }
    }
}

impl SweepAxes {
    /// ODE's constant for this order of axes.
    fn order(self) -> u32 {
        match self {
            Self::Xyz => dSAP_AXES_XYZ,
            Self::Xzy => dSAP_AXES_XZY,
            Self::Yxz => dSAP_AXES_YXZ,
            Self::Yzx => dSAP_AXES_YZX,
            Self::Zxy => dSAP_AXES_ZXY,
            Self::Zyx => dSAP_AXES_ZYX,
        }
    }
}

impl World {
    /// Adds an empty space inside `parent`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the parent was removed, or if a parameter of the kind is out of range.
    pub fn add_space(&mut self, parent: SpaceId, kind: SpaceKind) -> Result<SpaceId> {
        let kind = kind.checked()?;
        let raw_parent = self.spaces.find(parent)?.raw;
        // SAFETY: ODE is open as long as the world lives, and the parent was found alive.
        let raw = unsafe { kind.create(raw_parent) };
        Ok(SpaceId(self.spaces.insert(SpaceRecord { raw, parent: Some(parent.0), kind })))
    }

    /// Removes a space with all spaces and geoms in it, also those made with ODE's own functions. The bodies of these
    /// geoms remain.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for the root space, and if the space was removed before.
    pub fn remove_space(&mut self, id: SpaceId) -> Result<()> {
        self.spaces.find(id)?;
        if id.0 == self.root_key() {
            return Err(Error::argument(format!(
                "{id:?}: expected a space that can be removed, found the root"
            )));
        }

        // The contents first, since their records refer to ODE's objects, which the space destroys with itself.
        for space in self.space(id).inner_spaces() {
            self.remove_space(space)?;
        }
        for geom in self.geoms_in(id) {
            self.remove_geom(geom);
        }

        if let Some(record) = self.spaces.remove(id.0) {
            // SAFETY: the space was alive and its record was just removed; the world's objects in it are destroyed.
            unsafe { dSpaceDestroy(record.raw) };
        }
        Ok(())
    }

    /// Whether the space exists in this world.
    pub fn contains_space(&self, id: SpaceId) -> bool {
        self.spaces.get(id.0).is_some()
    }

    /// The ids of all spaces.
    pub fn spaces(&self) -> impl Iterator<Item = SpaceId> + '_ {
        self.spaces.iter().map(|(key, _)| SpaceId(key))
    }

    /// The kind of a space, if it exists in this world.
    pub fn space_kind(&self, id: SpaceId) -> Option<SpaceKind> {
        self.spaces.get(id.0).map(|record| record.kind)
    }

    /// The geoms directly in a space, not in its inner spaces; none if the space was removed.
    pub fn geoms_in(&self, space: SpaceId) -> Vec<GeomId> {
        self.geoms.iter().filter(|(_, geom)| geom.space == space.0).map(|(key, _)| GeomId(key)).collect()
    }

    /// Removes a geom. Returns false if it was removed before.
    ///
    /// Bodies that sleep on a visual hull wake when it is removed. Those on other geoms sleep on in the air, as in any
    /// program with ODE: [enable](super::BodyMut::set_enabled) them.
    pub fn remove_geom(&mut self, id: GeomId) -> bool {
        let Some(record) = self.geoms.remove(id.0) else { return false };
        self.wake_bodies_on(record.raw);
        clear_samples(record.raw);
        // SAFETY: the geom was alive, and its record was just removed, so it is destroyed only once. The data that the
        // geom borrows is in the record, which is dropped later.
        unsafe { dGeomDestroy(record.raw) };
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_out_of_range_are_refused() {
        let quad_tree = |extents, depth| SpaceKind::QuadTree { center: Point3::origin(), extents, depth };
        for bad in [
            SpaceKind::Hash { min_level: -6, max_level: 3 },
            SpaceKind::Hash { min_level: 2, max_level: 1 },
            SpaceKind::Hash { min_level: 2, max_level: 31 },
            quad_tree(Vector3::new(1.0, 0.0, 1.0), 3),
            quad_tree(Vector3::new(f64::NAN, 1.0, 1.0), 3),
            quad_tree(Vector3::repeat(1.0), 0),
            quad_tree(Vector3::repeat(1.0), 9),
        ] {
            assert!(bad.checked().is_err(), "{bad:?}");
        }
    }
}
