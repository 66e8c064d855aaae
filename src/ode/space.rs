//! Spaces: geoms grouped, so that not every pair is looked at.

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

/// How a space finds the pairs that may touch. All kinds find the same pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SpaceKind {
    /// Every geom against every other: for a few.
    Simple,
    /// Cells of sizes 2^`min_level` to 2^`max_level` metres; larger geoms are compared with all.
    Hash {
        /// At least -5.
        min_level: i32,
        /// Not below `min_level`, at most 30.
        max_level: i32,
    },
    /// Sorted along axes: for many geoms that move little.
    SweepAndPrune(SweepAxes),
    /// Nested squares of the x-y plane: for wide, flat scenes. What is outside of it is compared with all.
    QuadTree {
        /// The middle.
        center: Point3<f64>,
        /// Half the size in each direction; z does not matter.
        extents: Vector3<f64>,
        /// How often the squares are divided: 1 to 8.
        depth: u32,
    },
}

/// The order in which a [`SpaceKind::SweepAndPrune`] sorts: best first the axis along which geoms differ most.
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
    /// ODE's hash space: cells from 1/8 m to 1024 m.
    fn default() -> Self {
        Self::Hash { min_level: -3, max_level: 10 }
    }
}

/// A space of ODE that a world owns.
#[derive(Debug)]
pub(super) struct SpaceRecord {
    pub(super) raw: dSpaceID,
    pub(super) parent: Option<Key>,
    pub(super) kind: SpaceKind,
}

impl SpaceKind {
    pub(super) fn checked(self) -> Result<Self> {
        match self {
            Self::Simple | Self::SweepAndPrune(_) => {}
            Self::Hash { min_level, max_level } => {
                // With smaller cells the largest coordinate overflows ODE's cell numbers, where it aborts.
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

    /// # Safety
    ///
    /// ODE is open, `self` is checked, `parent` is null or a living space.
    pub(super) unsafe fn create(self, parent: dSpaceID) -> dSpaceID {
        // SAFETY: as the caller vouches; the vectors are copied.
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
    /// A new, empty space inside of `parent`.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the parent is gone, and for parameters of the kind that are out of range.
    pub fn add_space(&mut self, parent: SpaceId, kind: SpaceKind) -> Result<SpaceId> {
        let kind = kind.checked()?;
        let above = self.spaces.find(parent)?.raw;
        // SAFETY: ODE is open as long as the world lives, and the parent was found alive.
        let raw = unsafe { kind.create(above) };
        Ok(SpaceId(self.spaces.insert(SpaceRecord { raw, parent: Some(parent.0), kind })))
    }

    /// Removes a space with all spaces and geoms in it; their ids go stale, and bodies stay.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for the root space, and if the space is gone.
    pub fn remove_space(&mut self, id: SpaceId) -> Result<()> {
        self.spaces.find(id)?;
        if id.0 == self.root_key() {
            return Err(Error::argument(format!(
                "{id:?}: expected a space that can be removed, found the root"
            )));
        }
        let inner: Vec<_> = self.spaces.iter().filter(|(_, space)| space.parent == Some(id.0)).collect();
        for space in inner.into_iter().map(|(key, _)| SpaceId(key)).collect::<Vec<_>>() {
            self.remove_space(space)?;
        }
        for geom in self.geoms_in(id) {
            self.remove_geom(geom);
        }
        if let Some(record) = self.spaces.remove(id.0) {
            // SAFETY: the record was alive and is gone now; all that the world has inside of it is destroyed.
            unsafe { dSpaceDestroy(record.raw) };
        }
        Ok(())
    }

    /// Whether the space is there.
    pub fn contains_space(&self, id: SpaceId) -> bool {
        self.spaces.get(id.0).is_some()
    }

    /// All spaces.
    pub fn spaces(&self) -> impl Iterator<Item = SpaceId> + '_ {
        self.spaces.iter().map(|(key, _)| SpaceId(key))
    }

    /// The kind of a space, if it is there.
    pub fn space_kind(&self, id: SpaceId) -> Option<SpaceKind> {
        self.spaces.get(id.0).map(|record| record.kind)
    }

    /// The geoms in a space, without those of the spaces in it; none if the space is gone.
    pub fn geoms_in(&self, space: SpaceId) -> Vec<GeomId> {
        self.geoms.iter().filter(|(_, geom)| geom.space == space.0).map(|(key, _)| GeomId(key)).collect()
    }

    /// Removes a geom; false if it was gone already.
    pub fn remove_geom(&mut self, id: GeomId) -> bool {
        let Some(record) = self.geoms.remove(id.0) else { return false };
        clear_samples(record.raw);
        // SAFETY: the record was alive, and is gone now, so that this happens once. What the geom borrows is in the
        // record, which is dropped after.
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
