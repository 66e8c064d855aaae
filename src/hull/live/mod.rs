//! Live data: cameras write masks, view by view; simulations read frames, which are immutable hulls.

mod hull_data;
mod mask_filter;
mod moving_mask;
mod preparation;
mod view_state;

pub use hull_data::HullData;
pub use mask_filter::MaskFilter;
