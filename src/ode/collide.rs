//! Collision detection: the pairs of geoms of a world that may touch.

use ode_sys::{dJointGroupEmpty, dSpaceCollide, dSpaceCollide2};

use super::arena::GeomId;
use super::contacts::{ContactGeom, true_contacts};
use super::pair::Pair;
use super::pair_search::{near_callback, search_pairs};
use super::surface::Surface;
use super::world::World;
use super::{heightfield, panic};
use crate::Result;

impl World {
    /// Calls `visit` for every pair of geoms that may touch, so that it can attach contacts between them. The contacts
    /// of the last collide are removed first, and visual hulls switch to the latest published frame.
    ///
    /// Pairs are found across nested spaces, each pair once, and in the same order in each run. Two geoms of one
    /// body are left out, as are disabled geoms and geoms whose category and collide bits exclude each other.
    ///
    /// # Errors
    ///
    /// The first error of an [`attach`](Pair::attach), or of a pair that ODE cannot collide, see
    /// [`Shape::Heightfield`](super::Shape::Heightfield). All other pairs are visited, and their contacts attached.
    ///
    /// # Panics
    ///
    /// If `visit` panics. The remaining pairs are not visited, and the world remains usable.
    pub fn collide(&mut self, mut visit: impl FnMut(&Pair<'_>)) -> Result<()> {
        self.ode.ensure_thread_data()?;
        self.clear_contacts();
        self.begin_event_steps();
        self.apply_latest_frames();

        let searched = search_pairs(self, None, &mut visit, |data| {
            for (_, space) in self.spaces.iter() {
                // SAFETY: the space is alive; the search guarantees the rest.
                unsafe { dSpaceCollide(space.raw, data, Some(near_callback)) };
            }
            for [first, second] in self.overlooked_pairs() {
                // SAFETY: both are geoms or spaces of this world; the search guarantees the rest.
                unsafe { dSpaceCollide2(first, second, data, Some(near_callback)) };
            }
        });
        self.identify_touchers();
        searched
    }

    /// Collides all pairs and attaches up to `max` contacts with this surface to each, the usual collision step. Pairs
    /// without a body, and pairs of bodies that another joint connects, get none. Contacts with a visual hull in
    /// [`Motion`](crate::hull::Motion) move as the real surface does: see [`Pair::surface_motion`]. Friction with a visual
    /// hull is along the slip, so that it is Coulomb's, where the surface states no direction: see
    /// [`set_slip_friction`](Self::set_slip_friction) for other contacts, and [`Pair::slip_direction`]. Contacts of bodies that
    /// a hull presses from opposite sides are soft: see [`Pair::grip_softness`].
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) for a surface with NaN or numbers out of range.
    pub fn default_collide(&mut self, surface: &Surface, max: usize) -> Result<()> {
        surface.to_ode()?;
        let (dt, everywhere) = (self.last_dt, self.slip_friction);
        self.collide(|pair| {
            if pair.bodies() == [None, None] || pair.are_connected_excluding_contact() {
                return;
            }
            for contact in pair.contacts(max).iter() {
                let mut surface = pair.surface_at(contact, surface, dt);
                if everywhere && surface.friction_direction.is_none() {
                    surface.friction_direction = pair.slip_direction(contact, dt);
                }
                pair.attach(contact, &surface);
            }
        })
    }

    /// Whether [`default_collide`](Self::default_collide) directs the friction of all contacts along the slip, not only of
    /// those with a visual hull. Off by default, as in ODE.
    pub fn slip_friction(&self) -> bool {
        self.slip_friction
    }

    /// Sets [`slip_friction`](Self::slip_friction). A box that slides over ODE's plane then stops where Coulomb's law says, in
    /// all directions, and one that is pushed along the diagonal of ODE's friction directions begins to move.
    pub fn set_slip_friction(&mut self, everywhere: bool) {
        self.slip_friction = everywhere;
    }

    /// Removes the contacts that the last collide attached.
    pub fn clear_contacts(&mut self) {
        // SAFETY: the group is alive as long as the world, and no record refers to its joints.
        unsafe { dJointGroupEmpty(self.contacts) };
        self.buffers.measured.get_mut().clear();
    }

    /// Up to `max` contacts of two geoms in any spaces, without attaching them.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) if a geom was removed, and for a pair that ODE cannot collide, see
    /// [`Shape::Heightfield`](super::Shape::Heightfield).
    pub fn collide_geoms(&mut self, first: GeomId, second: GeomId, max: usize) -> Result<Vec<ContactGeom>> {
        self.ode.ensure_thread_data()?;
        let raw = [self.geoms.find(first)?.raw, self.geoms.find(second)?.raw];
        heightfield::check_pair(self, [first, second])?;
        self.apply_latest_frames();
        let found = true_contacts(self, raw, [first, second], max, 0).to_vec();
        panic::resume_parked();
        Ok(found)
    }
}
