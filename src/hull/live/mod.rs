//! What cameras write and simulations read: masks come in view by view, frames go out as immutable hulls.

mod hull_data;
mod view_state;

pub use hull_data::HullData;
