//! The class held open for programs that own ODE themselves.

use super::class;
use crate::lock::lock;
use crate::ode::init::Ode;
use crate::{Error, Result};
use std::sync::{Mutex, MutexGuard};

/// How often the class is open, and the reference on ODE that the openings share.
#[derive(Debug)]
struct Openings {
    count: usize,
    ode: Option<Ode>,
}

static OPENINGS: Mutex<Openings> = Mutex::new(Openings { count: 0, ode: None });

fn openings() -> MutexGuard<'static, Openings> {
    lock(&OPENINGS)
}

impl Openings {
    /// Forgets the reference on ODE where the program has closed ODE beneath the class, by one `dCloseODE` too many. The
    /// program may have opened ODE again since, and dropping the reference would close that.
    fn drop_if_stolen(&mut self) {
        if self.ode.is_some()
            && !class::is_still_registered()
            && let Some(ode) = self.ode.take()
        {
            ode.forget();
        }
    }
}

/// Opens the class; each opening is closed by one [`close_class`].
///
/// # Errors
/// The errors of [`Ode::init`], and a full table of user classes.
pub(crate) fn open() -> Result<()> {
    let mut openings = openings();
    openings.drop_if_stolen();
    if openings.ode.is_none() {
        let ode = Ode::init()?;
        class::number()?;
        openings.ode = Some(ode);
    }
    openings.count += 1;
    Ok(())
}

/// Closes one opening of the class.
///
/// # Errors
/// The class is not open.
pub(crate) fn close_class() -> Result<()> {
    let mut openings = openings();
    openings.count = openings.count.checked_sub(1).ok_or_else(closed)?;
    if openings.count == 0 {
        openings.drop_if_stolen();
        openings.ode = None;
    }
    Ok(())
}

/// The class's number while the class is open.
///
/// # Errors
/// The class is not open, or ODE was closed beneath it.
pub(crate) fn number() -> Result<i32> {
    let mut openings = openings();
    if openings.count == 0 {
        return Err(closed());
    }

    // The program may have closed ODE beneath the class.
    openings.drop_if_stolen();
    if openings.ode.is_none() {
        return Err(Error::Ode(
            "expected ODE open, found that it was closed beneath the class; call dInitVisualHull again, and \
             dCloseODE once for each dInitODE2 of your own"
                .into(),
        ));
    }
    class::number()
}

fn closed() -> Error {
    Error::Ode("expected the class open, found it closed; call dInitVisualHull first".into())
}
