//! The visual hull as a geometry class of ODE.
//!
//! ```text
//!   ODE's collide ─► class ─► collider ─► prefetch ─► contact::collide_many
//!                                │            └► query ─► body_samples
//!                                ├► geom: the frame in force, settings, last_contacts, lost_views
//!                                ├► depth_limit, by step_size
//!                                ├► last_contacts, by which grip softens contacts
//!                                ├► swept ─► contact::sweep, with a contact_time
//!                                ├► events, by hull::parts
//!                                └► hold ─► held_body ─► hull::Track, in place of contacts
//!
//!   programs in Rust: view ─► raw ◄─ open_class: programs that own ODE themselves
//! ```

mod body_samples;
mod canary;
mod class;
mod collider;
mod contact_time;
mod depth_limit;
mod event_view;
mod events;
mod geom;
mod grip;
mod held_body;
mod hold;
mod impact;
mod last_contacts;
mod last_swept;
mod lost_views;
mod neighbours;
mod open_class;
mod prefetch;
mod query;
mod raw;
mod restitution;
mod step_size;
mod surface_motion;
mod swept;
mod view;
mod wake;

pub(crate) use body_samples::{clear_samples, set_samples};
pub(crate) use contact_time::contact_seconds;
pub use event_view::{HullEvent, HullEvents};
pub use events::HullEventKind;
pub(crate) use events::TouchEvent;
pub(crate) use geom::take_last_error;
pub use grip::Softness;
pub(super) use grip::grip_softness;
pub(crate) use open_class::{close_class, number as open_class_number, open as open_class};
pub(crate) use raw::{RawHull, apply_latest_frame_everywhere, create_in as create_hull_in};
pub(super) use restitution::Restitution;
pub use surface_motion::SurfaceMotion;
pub(crate) use surface_motion::set_contact_motion;
pub(super) use surface_motion::{Touching, surface_motion};
pub use swept::Swept;
pub use view::{HullMut, HullView};
