//! The constants that decide how bodies behave on a hull, each with its unit and with what changes when it does.
//!
//! They were found by simulating boxes, balls and stacks on exact and on noisy silhouettes. A change of any of them
//! changes trajectories. Two more that contacts rest on stand in lower layers: the width of the contact normal's kernel
//! and the shortest mean that has a direction, `silhouette::contact_edge` and `silhouette::edge`.

/// Cosine between a sample's exit direction and the body's outward normal up to which the sample is supported. Nearer
/// to 0, samples of a deep rim found clusters of their own and throw a box off sideways; nearer to -1, a tilted face
/// loses its support.
pub(crate) const SUPPORTED_COSINE: f64 = -0.3;

/// Cosine of 35 degrees: samples whose exit directions lie within this of a cluster's mean join it. At 20 degrees one
/// face falls into two clusters; 35 to 60 are alike.
pub(crate) const JOIN_COSINE: f64 = 0.819_152_044_288_991_8;

/// Metres added to every exit vector's length in a cluster's mean, so that one of length zero still counts by its
/// direction. Large values let shallow samples bend the mean.
pub(crate) const DIRECTION_WEIGHT: f64 = 1e-6;

/// Factor on the cost of the last step's escape direction, so that a swallowed or pierced body does not change its mind
/// from step to step. At 1 it trembles between two exits; near 0 it keeps one that has become long.
pub(crate) const HYSTERESIS: f64 = 0.3;

/// Samples at most, evenly over their order, that are asked for an escape direction. Fewer may miss a limb that stays
/// behind; more cost time with no effect on bodies of up to 400 samples.
pub(crate) const ESCAPE_SAMPLES: usize = 64;

/// Part of a manifold's deepest depth from which on a point counts as deepest; the first such starts the reduction, so
/// that noise in the depths of a body at rest does not change the choice. At 1 the choice flickers; much lower, the
/// deepest corner of a tilted box may be left out.
pub(crate) const DEEPEST_FRACTION: f64 = 0.8;

/// Ratio of squared distances by more than which a point counts as farther in the reduction. At 1 rounding decides among
/// the corners of a square, and the choice differs from pose to pose.
pub(crate) const FARTHER_RATIO: f64 = 1.0 + 1e-6;

/// Part of another point's depth below which a point of the same manifold may be transient. At 0 every grazing sample of
/// a tilted face becomes a pivot, and a box on a box stays on its edge.
pub(crate) const SHALLOW_RATIO: f64 = 0.7;

/// Difference in depth over distance, 0.3 degrees, by more than which a shallow point is transient: the body is still
/// tilting about a deeper one. Smaller, noise takes contacts from a face that lies.
pub(crate) const MIN_TILT: f64 = 0.005;

/// Default of [`Settings::max_depth`](super::Settings::max_depth), in metres. Without it a swallowed box leaves at 8 to
/// 33 m/s, with it at about 1; below 2 cm bodies sink while they are pushed.
pub(crate) const MAX_DEPTH: f64 = 0.05;

/// Default of [`Settings::max_contacts`](super::Settings::max_contacts). Four carry a face; eight also grips and rims.
/// More cost the solver time.
pub(crate) const MAX_CONTACTS: usize = 8;

/// Default `min_feature` of a hull geom, in metres: a real feature of this diameter cannot pass between samples. Larger,
/// fingers go through bodies; smaller, cost grows with its square.
#[cfg(feature = "ode")]
pub(crate) const MIN_FEATURE: f64 = 0.03;

/// Pixels of the nearest view by more than which the depth at a sleeping body has to change to wake it: more than a
/// flickering edge pixel moves the surface, less than is seen. At 0 noise keeps every body awake.
#[cfg(feature = "ode")]
pub(crate) const WAKE_PX: f64 = 1.5;
