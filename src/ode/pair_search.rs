//! The search for pairs of geoms that may touch: ODE's near callback, and the search for the pairs of one geom.

use std::any::Any;
use std::cell::Cell;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use ode_sys::{dGeomID, dGeomIsEnabled, dGeomIsSpace, dSpaceCollide2};

use super::arena::{GeomId, SpaceId};
use super::pair::Pair;
use super::world::World;
use super::{heightfield, panic};
use crate::{Error, Result};

/// The state of a search that ODE passes to its near callback.
struct PairSearch<'c> {
    world: &'c World,
    visit: &'c mut dyn FnMut(&Pair<'_>),
    first_error: &'c Cell<Option<Error>>,
    /// The geom that comes first in each pair, if all pairs are its own.
    first: Option<dGeomID>,
    /// The panic of `visit`, after which no more pairs are visited.
    panic: Option<Box<dyn Any + Send>>,
}

impl World {
    /// Calls `visit` for every geom in `space` and its inner spaces that `geom` may touch. The first geom of each pair
    /// is `geom`. Visual hulls switch to the latest published frame.
    ///
    /// So a ray finds its hits without a collide of the whole world. `geom` may be in any space, also in this one. As
    /// in [`collide`](Self::collide), geoms of the same body are left out, as are disabled geoms and geoms whose
    /// category and collide bits exclude each other; if `geom` itself is disabled there are no pairs.
    ///
    /// Contacts that are attached last until the next [`collide`](Self::collide), those of the last one remain.
    ///
    /// ```
    /// use nalgebra::{Isometry3, Point3, Vector3};
    /// use ode_visual_hull::ode::{Ode, Shape, World};
    ///
    /// # fn main() -> ode_visual_hull::Result<()> {
    /// let mut world = World::new(&Ode::init()?)?;
    /// let root = world.root_space();
    /// for (radius, x) in [(0.5, 4.0), (1.0, 7.0)] {
    ///     let ball = world.add_geom(root, &Shape::Sphere { radius })?;
    ///     world.geom_mut(ball).set_pose(&Isometry3::translation(x, 0.0, 0.0))?;
    /// }
    /// let ray = world.add_geom(root, &Shape::Ray { length: 100.0 })?;
    /// world.geom_mut(ray).set_ray(&Point3::origin(), &Vector3::x())?;
    ///
    /// // The nearest hit over all geoms. The depth of a hit is its distance from the ray's origin.
    /// let mut hits = Vec::new();
    /// world.collide_geom_with_space(ray, root, |pair| hits.extend_from_slice(&pair.contacts(8)))?;
    /// let nearest = hits.iter().min_by(|a, b| a.depth.total_cmp(&b.depth)).expect("the ray meets both balls");
    /// assert!((nearest.position - Point3::new(3.5, 0.0, 0.0)).norm() < 1e-12);
    /// assert!((nearest.normal + Vector3::x()).norm() < 1e-12);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the geom or the space was removed; else the first error of an [`attach`](Pair::attach)
    /// and of pairs that ODE cannot collide, as in [`collide`](Self::collide).
    ///
    /// # Panics
    ///
    /// If `visit` panics. The remaining pairs are not visited, and the world remains usable.
    pub fn collide_geom_with_space(
        &mut self,
        geom: GeomId,
        space: SpaceId,
        mut visit: impl FnMut(&Pair<'_>),
    ) -> Result<()> {
        let (geom, space) = (self.geoms.find(geom)?.raw, self.spaces.find(space)?.raw);
        self.ode.ensure_thread_data()?;
        self.apply_latest_frames();

        // SAFETY: geom and space are alive; the search below guarantees the rest.
        search_pairs(self, Some(geom), &mut visit, |data| unsafe {
            dSpaceCollide2(geom, space.cast(), data, Some(near_callback));
        })
    }
}

/// Calls `run`, which passes its argument and [`near_callback`] to ODE's searches in spaces of `world`, and calls
/// `visit` for each pair.
///
/// If `first` is a geom, all pairs that ODE finds have to contain it, and it becomes the first of each pair.
///
/// No geom is added, moved or removed meanwhile, which ODE would not survive: that needs the world mutably.
pub(super) fn search_pairs(
    world: &World,
    first: Option<dGeomID>,
    visit: &mut dyn FnMut(&Pair<'_>),
    run: impl FnOnce(*mut c_void),
) -> Result<()> {
    let first_error = Cell::new(None);
    let mut search = PairSearch { world, visit, first_error: &first_error, first, panic: None };
    run((&raw mut search).cast());

    // Panics of the closure, and then of the hull's callbacks, resume here, outside of ODE.
    if let Some(payload) = search.panic.take() {
        resume_unwind(payload);
    }
    panic::resume_parked();
    first_error.take().map_or(Ok(()), Err)
}

/// ODE's near callback: descends into spaces, and passes pairs of geoms to the closure of the search.
///
/// # Safety
///
/// Only ODE calls it, with the argument of the closure of [`search_pairs`] as `data`.
pub(super) unsafe extern "C" fn near_callback(data: *mut c_void, first: dGeomID, second: dGeomID) {
    // SAFETY: ODE passes living geoms.
    let is_space = |geom| unsafe { dGeomIsSpace(geom) != 0 };
    if is_space(first) || is_space(second) {
        // Only pairs across the two: `World::collide` visits the pairs within each space itself.
        // SAFETY: ODE passes living geoms or spaces, and the caller of this callback passed `data`.
        unsafe { dSpaceCollide2(first, second, data, Some(near_callback)) };
        return;
    }

    // SAFETY: `data` is the search of `search_pairs`, and no other reference to it is in use, since each callback
    // returns before the next one begins.
    let search = unsafe { &mut *data.cast::<PairSearch<'_>>() };
    // ODE ignores the enabled flag of geoms in the smaller of two spaces, so it is checked here. A geom without a body
    // that is collided with its own space is also paired with itself.
    // SAFETY: both geoms are alive.
    let enabled = [first, second].iter().all(|&geom| unsafe { dGeomIsEnabled(geom) != 0 });
    if search.panic.is_some() || !enabled || first == second {
        return;
    }
    let (first, second) = if search.first == Some(second) { (second, first) } else { (first, second) };

    // Geoms that were added through ODE's own functions and not adopted have no id, and are left out.
    // SAFETY: both geoms are alive.
    let ids = unsafe { (search.world.geom_id(first), search.world.geom_id(second)) };
    if let (Some(a), Some(b)) = ids {
        let (world, first_error) = (search.world, search.first_error);
        if let Err(error) = heightfield::check_pair(world, [a, b]) {
            first_error.set(Some(first_error.take().unwrap_or(error)));
            return;
        }
        let pair = Pair { world, first_error, raw: [first, second], geoms: [a, b] };
        // A panic that unwinds through ODE would leave its spaces locked. `search_pairs` resumes it.
        search.panic = catch_unwind(AssertUnwindSafe(|| (search.visit)(&pair))).err();
    }
}
