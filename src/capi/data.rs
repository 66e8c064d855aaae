//! The table of data objects, by their ids in C.
//!
//! An id is a serial number in the form of a pointer. It is never dereferenced and never reused, so the id of a
//! destroyed object is always refused.

use crate::hull::HullData;
use crate::lock::lock;
use crate::{Error, Result};
use std::collections::HashMap;
use std::ffi::c_void;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard};

/// `dVisualHullDataID`.
pub type DataId = *mut c_void;

/// The step between two ids, which makes them look like aligned addresses.
const STEP: usize = 16;

#[derive(Debug, Default)]
struct Table {
    objects: HashMap<usize, Arc<HullData>>,
    /// The number of objects made so far, destroyed ones included.
    made: usize,
}

static TABLE: LazyLock<Mutex<Table>> = LazyLock::new(Mutex::default);

/// The locked table.
fn table() -> MutexGuard<'static, Table> {
    lock(&TABLE)
}

/// Makes a data object without views, and returns its id.
pub(super) fn create() -> DataId {
    let mut table = table();
    table.made += 1;
    let id = table.made * STEP;
    table.objects.insert(id, Arc::new(HullData::new()));
    id as DataId
}

/// Removes a data object from the table. Geoms that are bound to it keep it alive.
pub(super) fn destroy(id: DataId) -> Result<()> {
    let removed = table().objects.remove(&(id as usize));
    removed.map(drop).ok_or_else(|| no_data(id))
}

/// The data object of an id.
pub(super) fn get(id: DataId) -> Result<Arc<HullData>> {
    table().objects.get(&(id as usize)).cloned().ok_or_else(|| no_data(id))
}

/// The id of a data object, or NULL if it was destroyed.
pub(super) fn id_of(data: &Arc<HullData>) -> DataId {
    let table = table();
    let found = table.objects.iter().find(|(_, object)| Arc::ptr_eq(object, data));
    found.map_or(0, |(id, _)| *id) as DataId
}

/// The error for an id that is not in the table.
fn no_data(id: DataId) -> Error {
    let found =
        if id.is_null() { "NULL".to_owned() } else { format!("{id:?}, which is not an id or was destroyed") };
    Error::argument(format!("data: expected an id from dGeomVisualHullDataCreate, found {found}"))
}
