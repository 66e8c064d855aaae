//! The constants that decide how bodies behave on a hull, each with its unit and the effect of changing it.
//!
//! They were found by simulating boxes, balls and stacks on exact and on noisy silhouettes. Changing any of them
//! changes trajectories. Two more constants affect contacts: the width of the contact normal's kernel, in
//! `silhouette::contact_edge`, and the shortest mean vector with a usable direction, in `silhouette::edge`.

/// Cosine between a sample's exit direction and the body's outward normal up to which the sample is supported. Nearer
/// to 0, samples of a deep rim start clusters of their own and throw a box off sideways; nearer to -1, a tilted face
/// loses its support.
pub(crate) const SUPPORTED_COSINE: f64 = -0.3;

/// Cosine of 35 degrees: samples whose exit directions lie within this angle of a cluster's mean join it. At 20 degrees
/// one face falls into two clusters; 35 to 60 degrees make no difference.
pub(crate) const JOIN_COSINE: f64 = 0.819_152_044_288_991_8;

/// Metres added to every exit vector's length in a cluster's mean, so that a vector of length zero still counts by its
/// direction. Large values give shallow samples too much weight in the mean.
pub(crate) const DIRECTION_WEIGHT: f64 = 1e-6;

/// Factor on the cost of the last step's escape direction, so that a swallowed or pierced body does not change its
/// direction from step to step. At 1 it oscillates between two exits; near 0 it keeps an exit that has become long.
pub(crate) const HYSTERESIS: f64 = 0.3;

/// Largest number of samples, evenly spaced in their order, that are used to rate an escape direction. Fewer may miss a
/// part of the body that stays inside; more cost time without an effect on bodies of up to 400 samples.
pub(crate) const ESCAPE_SAMPLES: usize = 64;

/// Fraction of a manifold's largest depth from which on a point counts as deepest. The reduction starts from the first
/// such point, so that noise in the depths of a body at rest does not change the choice. At 1 the choice flickers; much
/// lower, the deepest corner of a tilted box may be left out.
pub(crate) const DEEPEST_FRACTION: f64 = 0.8;

/// Ratio of squared distances above which a point counts as farther in the reduction. At 1 rounding decides among the
/// corners of a square, and the choice differs from pose to pose.
pub(crate) const FARTHER_RATIO: f64 = 1.0 + 1e-6;

/// Fraction of another point's depth below which a point of the same manifold may be transient. At 0 every grazing
/// sample of a tilted face becomes a pivot, and a box on a box stays on its edge.
pub(crate) const SHALLOW_RATIO: f64 = 0.7;

/// Difference in depth over distance (0.3 degrees) above which a shallow point is transient, because the body is still
/// tilting about a deeper one. A smaller value lets noise remove contacts from a face that lies flat.
pub(crate) const MIN_TILT: f64 = 0.005;

/// Default of [`Settings::max_depth`](super::Settings::max_depth), in metres. Without a limit a swallowed box leaves at
/// 8 to 33 m/s, with this one at about 1 m/s at 100 Hz; below 2 cm bodies sink in while they are pushed.
pub(crate) const MAX_DEPTH: f64 = 0.05;

/// The largest speed in m/s at which depth moves a body out of a hull geom, beside the speed of the surface: what appears
/// inside a body throws it no faster. With a larger value such a body is flung, with a smaller one it stays inside for long.
#[cfg(feature = "ode")]
pub(crate) const LEAVING_SPEED: f64 = 0.7;

/// Default of [`Settings::max_contacts`](super::Settings::max_contacts). Four contacts support a face; eight also
/// suffice for grips and rims. More cost the solver time.
pub(crate) const MAX_CONTACTS: usize = 8;

/// Largest number of contacts of one body with a hull that it does not touch yet. Four stop a face without turning it; more
/// cost the solver time.
#[cfg(feature = "ode")]
pub(crate) const MAX_SWEPT_CONTACTS: usize = 4;

/// Default `min_feature` of a hull geom, in metres: a real feature of this diameter cannot pass between samples. With a
/// larger value fingers go through bodies; the cost grows with the inverse square of the value.
#[cfg(feature = "ode")]
pub(crate) const MIN_FEATURE: f64 = 0.03;

/// Growth of the depth at a body when views are lost, in pixels of the nearest view, above which their last masks
/// stay valid for the body. With a large value bodies are pushed visibly when the hull grows; at 0 the last masks also
/// hide real motion from bodies over which the hull has hardly grown.
#[cfg(feature = "ode")]
pub(crate) const GROWTH_PX: f64 = 0.5;

/// Change of the depth at a sleeping body, in pixels of the nearest view, above which the body is woken. A flickering
/// edge pixel moves the surface by less, and a larger change would be visible. At 0 noise keeps every body awake.
#[cfg(feature = "ode")]
pub(crate) const WAKE_PX: f64 = 1.5;
