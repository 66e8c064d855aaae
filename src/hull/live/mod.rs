//! Live data: cameras write masks, view by view; simulations read frames, which are immutable hulls.

mod hull_data;
mod view_state;

pub use hull_data::HullData;
