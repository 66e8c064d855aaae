//! The visual hull as a geometry class of ODE.
//!
//! ```text
//!   class ─► collider ─► prefetch ─► contacts of all bodies of a space
//!              │           └► body_samples
//!              └► geom: the frame in force, settings, what it touched last
//!   view (programs in Rust) ─► raw ◄─ open_class (programs that own ODE themselves)
//! ```

mod body_samples;
mod class;
mod collider;
mod geom;
mod open_class;
mod prefetch;
mod raw;
mod view;

pub(crate) use body_samples::{clear_samples, set_samples};
pub(crate) use geom::take_last_error;
pub(crate) use open_class::{close_class, number as open_class_number, open as open_class};
pub(crate) use raw::{RawHull, adopt_everywhere, create_in as create_hull_in};
pub use view::{HullMut, HullView};
