//! The class held open by callers who own ODE themselves.

use super::init::Ode;
use super::{abort, hull_class};
use crate::{Error, Result};
use ode_sys::{dAllocateMaskAll, dAllocateODEDataForThread};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How often the class was opened, and the reference on ODE that the openings share.
static OPENINGS: Mutex<(usize, Option<Ode>)> = Mutex::new((0, None));

fn openings() -> MutexGuard<'static, (usize, Option<Ode>)> {
    OPENINGS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Opens the class once more.
///
/// # Errors
/// As [`Ode::init`], and a full table of user classes.
pub(crate) fn open() -> Result<()> {
    let mut openings = openings();
    let ode = openings.1.take().map_or_else(Ode::init, Ok)?;
    hull_class::number()?;
    *openings = (openings.0 + 1, Some(ode));
    Ok(())
}

/// Gives one opening back.
///
/// # Errors
/// None is left.
pub(crate) fn close() -> Result<()> {
    let mut openings = openings();
    match openings.0 {
        0 => return Err(closed()),
        1 => *openings = (0, None),
        n => openings.0 = n - 1,
    }
    Ok(())
}

/// The class's number while it is open.
///
/// # Errors
/// It was not opened, or ODE was closed beneath it.
pub(crate) fn number() -> Result<i32> {
    let openings = openings();
    if openings.1.is_none() {
        return Err(closed());
    }
    // SAFETY: where ODE is closed it refuses before it changes anything, else it makes sure of what is there.
    let alive = unsafe { abort::guarded(|| dAllocateODEDataForThread(dAllocateMaskAll as u32)) };
    alive.map_err(|words| {
        Error::Ode(format!("expected ODE open, found it closed beneath the class ({words})"))
    })?;
    hull_class::number()
}

fn closed() -> Error {
    Error::Ode("expected the class open, found it closed; call dInitVisualHull first".into())
}
