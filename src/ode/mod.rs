//! A safe wrapper of the [Open Dynamics Engine](https://ode.org).
//!
//! [`Ode::init`] opens ODE. A [`World`] owns all objects of one scene: bodies (mass and motion), geoms (collision
//! shapes), spaces (groups of geoms for the broad phase) and joints. They are addressed by small copyable ids. An id of
//! a removed object, or of another world, is refused and never reaches freed memory.
//!
//! ```text
//!   Ode ── World ──┬── spaces ── geoms ─┐ a geom may be attached to a body
//!                  ├── bodies ──────────┘
//!                  └── joints, contacts   between two bodies, or a body and the world
//! ```
//!
//! Units are metres, kilograms, seconds and radians; any axis may point up. ODE aborts the process on many invalid
//! arguments, and on a NaN in a hash space. This wrapper checks arguments first and returns a [`crate::Error`] instead.
//!
//! ```
//! use nalgebra::{Isometry3, Vector3};
//! use ode_visual_hull::ode::{Amount, Mass, Ode, Shape, Surface, World};
//!
//! # fn main() -> ode_visual_hull::Result<()> {
//! let ode = Ode::init()?;
//! let mut world = World::new(&ode)?;
//! world.set_gravity(&Vector3::new(0.0, 0.0, -9.81))?;
//! let root = world.root_space();
//! world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 })?;
//!
//! let cube = Shape::Box { sides: Vector3::repeat(0.2) };
//! let body = world.add_body();
//! world.body_mut(body).set_mass(&Mass::of(&cube, Amount::Total(1.0))?)?;
//! world.body_mut(body).set_pose(&Isometry3::translation(0.0, 0.0, 0.3))?;
//! let geom = world.add_geom(root, &cube)?;
//! world.geom_mut(geom).set_body(Some(body))?;
//!
//! for _ in 0..100 {
//!     world.collide(|pair| {
//!         for contact in pair.contacts(8).iter() {
//!             pair.attach(contact, &Surface::default());
//!         }
//!     })?;
//!     world.quick_step(0.01)?;
//! }
//! assert!((world.body(body).position().z - 0.1).abs() < 1e-3);
//! # Ok(())
//! # }
//! ```

#![allow(unsafe_code)]

mod abort;
mod arena;
mod body;
mod check;
mod collide;
mod contacts;
mod convert;
mod geom;
mod hash_space;
mod heightfield;
mod hull;
mod init;
#[cfg(test)]
pub(crate) mod injected_panic;
mod joint;
mod mass;
mod pair;
mod pair_search;
mod panic;
mod parameters;
pub(crate) mod per_thread;
mod raw;
mod shape;
mod slip;
mod space;
mod step;
mod surface;
mod trimesh;
mod world;

pub use arena::{BodyId, GeomId, JointGroupId, JointId, SpaceId};
pub use body::{Body, BodyMut};
pub use check::{MIN_SIZE, REACH};
pub use contacts::{ContactGeom, Contacts};
pub use geom::{Geom, GeomMut, RayFlags};
pub use hull::{HullEvent, HullEventKind, HullEvents, HullMut, HullView, Softness, SurfaceMotion, Swept};
pub use init::{Ode, random_seed, set_random_seed};
pub use joint::{
    AxisFrame, Joint, JointAxis, JointFeedback, JointKind, JointMut, JointParam, JointType, MotorAxis,
};
pub use mass::{Amount, Mass};
pub use pair::Pair;
pub use parameters::{AutoDisable, Damping};
pub use space::{Space, SpaceKind, SweepAxes};
pub use surface::{Approximation, Surface};
pub use world::World;

pub use crate::shape::{Convex, Heightfield, Shape, TriMesh};
pub use ode_sys;

pub(crate) use hull::{
    RawHull, TouchEvent, apply_latest_frame_everywhere, clear_samples, close_class, contact_seconds,
    create_hull_in, open_class, open_class_number, set_contact_motion, set_samples, take_last_error,
};
pub(crate) use panic::{catch, is_fenced, take_parked as take_parked_panic};
pub(crate) use slip::set_contact_friction;
