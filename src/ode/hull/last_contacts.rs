//! How each body met a hull geom when it was last awake: what wakes sleeping bodies, and which escape direction to keep.

use crate::contact::tuning::WAKE_PX;
use crate::lock::lock;
use nalgebra::Vector3;
use std::collections::HashMap;
use std::sync::Mutex;

/// Collides after which a contact that was not renewed is forgotten.
const FORGET_AFTER: u64 = 1000;

/// The last contacts of all bodies with one hull geom, under the addresses of the bodies' geoms.
///
/// An address is a hint only: by now it may be another geom's. It is compared and never followed.
#[derive(Debug, Default)]
pub(super) struct LastContacts {
    table: Mutex<Table>,
}

#[derive(Debug, Default)]
struct Table {
    by_geom: HashMap<usize, LastContact>,
    /// How often the hull geom has collided.
    collide_count: u64,
}

#[derive(Debug, Clone, Copy)]
struct LastContact {
    /// The deepest contact's depth in metres; `None` without contact.
    depth: Option<f64>,
    /// The escape direction that was chosen, in the hull's frame.
    escape: Option<Vector3<f64>>,
    /// The [`Table::collide_count`] at which it was renewed.
    renewed: u64,
}

/// What a collide has found of one body.
pub(super) struct NewContact {
    /// The address of the body's geom.
    pub(super) other: usize,
    pub(super) is_asleep: bool,
    /// The deepest contact's depth in metres; `None` without contact.
    pub(super) depth: Option<f64>,
    /// The escape direction that was chosen, in the hull's frame.
    pub(super) escape: Option<Vector3<f64>>,
    /// Metres that a pixel covers at the body.
    pub(super) pixel_size: f64,
}

impl LastContacts {
    /// Counts a collide of the hull geom.
    pub(super) fn count_collide(&self) {
        lock(&self.table).collide_count += 1;
    }

    /// The escape direction chosen last for the geom at address `other`, in the hull's frame.
    pub(super) fn escape(&self, other: usize) -> Option<Vector3<f64>> {
        lock(&self.table).by_geom.get(&other)?.escape
    }

    /// Records a contact. Returns true where the body sleeps and should wake, since the hull's surface at it is no longer
    /// where it was when the body fell asleep.
    pub(super) fn record(&self, new: &NewContact) -> bool {
        let mut table = lock(&self.table);
        table.forget_old();
        let NewContact { other, is_asleep, depth, escape, pixel_size } = *new;
        let renewed = table.collide_count;

        // A sleeping body keeps its record, so that slow motions of the surface add up.
        if is_asleep && let Some(last) = table.by_geom.get_mut(&other) {
            last.renewed = renewed;
            let has_moved = match (last.depth, depth) {
                (Some(before), Some(now)) => (now - before).abs() > WAKE_PX * pixel_size,
                (None, None) => false,
                _ => true,
            };
            if has_moved {
                last.depth = depth;
            }
            return has_moved;
        }

        table.by_geom.insert(other, LastContact { depth, escape, renewed });
        false
    }
}

impl Table {
    /// Removes contacts that were not renewed for long; their geoms may be gone.
    fn forget_old(&mut self) {
        let now = self.collide_count;
        if now.is_multiple_of(FORGET_AFTER) {
            self.by_geom.retain(|_, last| last.renewed + FORGET_AFTER >= now);
        }
    }
}
