//! Data objects by their ids.
//!
//! An id is a number that is never used again, dressed as a pointer that is never followed: a stale one is refused
//! whatever has been allocated since.

use crate::hull::HullData;
use crate::lock::lock;
use crate::{Error, Result};
use std::collections::HashMap;
use std::ffi::c_void;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard};

/// `dVisualHullDataID`.
pub type DataId = *mut c_void;

/// Ids look like aligned addresses.
const STEP: usize = 16;

#[derive(Debug, Default)]
struct Table {
    objects: HashMap<usize, Arc<HullData>>,
    made: usize,
}

static TABLE: LazyLock<Mutex<Table>> = LazyLock::new(Mutex::default);

fn table() -> MutexGuard<'static, Table> {
    lock(&TABLE)
}

pub(super) fn create() -> DataId {
    let mut table = table();
    table.made += 1;
    let id = table.made * STEP;
    table.objects.insert(id, Arc::new(HullData::new()));
    id as DataId
}

pub(super) fn destroy(id: DataId) -> Result<()> {
    let removed = table().objects.remove(&(id as usize));
    removed.map(drop).ok_or_else(|| no_data(id))
}

pub(super) fn get(id: DataId) -> Result<Arc<HullData>> {
    table().objects.get(&(id as usize)).cloned().ok_or_else(|| no_data(id))
}

/// The id of an object, NULL once it was destroyed.
pub(super) fn id_of(data: &Arc<HullData>) -> DataId {
    let table = table();
    let found = table.objects.iter().find(|(_, object)| Arc::ptr_eq(object, data));
    found.map_or(0, |(id, _)| *id) as DataId
}

fn no_data(id: DataId) -> Error {
    let found =
        if id.is_null() { "NULL".to_owned() } else { format!("{id:?}, which is none or was destroyed") };
    Error::argument(format!("data: expected an id from dGeomVisualHullDataCreate, found {found}"))
}
