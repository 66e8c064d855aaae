//! The visual hull of a real, moving subject as a collision shape for rigid bodies.
//!
//! Calibrated cameras see a subject as silhouettes. The points that every camera sees as subject form its *visual
//! hull*, and virtual bodies collide with that: it is one more geometry class of the Open Dynamics Engine. New
//! silhouettes arrive, the next step collides with them, nothing is rebuilt.
//!
//! ```text
//!      cam0 >- - - - - - .#####. - - - - - < cam2         a sample of a body's surface that all
//!                        #  o--#-->                       silhouettes hold (o) collides; the nearest
//!                        '#####'                          silhouette edge tells which way and how far
//!                           ^
//!                         cam1
//! ```
//!
//! # The layers
//!
//! Each stands on those above it; only [`ode`] knows of ODE.
//!
//! | module | what it is |
//! |---|---|
//! | [`camera`] | one calibrated view: projection, viewing rays, lenses |
//! | [`rig`] | a named set of cameras, and the files it is read from |
//! | [`silhouette`] | one view's mask, prepared: bounding rectangle, distances, edge normals |
//! | [`hull`] | the shape: inside, exits, rays; [`hull::HullData`] takes masks and publishes frames |
//! | [`shape`] | the shapes of the virtual bodies |
//! | [`sample`] | surface samples of the virtual bodies |
//! | [`contact`] | a body against a hull: clusters of samples, a few contacts |
//! | [`ode`] | a safe wrapper of ODE, and the hull as a geometry class |
//!
//! Beside them: [`source`] brings colour images from folders, videos and cameras, [`segment`] makes silhouettes of
//! them, [`pipeline`] takes the images of all cameras through both to the hull, [`recording`] reads and writes what
//! cameras saw, and [`synthetic`] renders subjects of known geometry, to try a camera layout before buying cameras. The
//! package `ode-visual-hull-check` tests whether silhouettes fit one another.
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `ode` (default) | the module [`ode`] and the C functions; needs libode and libclang to build |
//! | `threads` | [`contact::collide_many`] and what else takes many bodies shares them out to rayon's current pool |
//! | `capi` | nothing by itself: cargo-c sets it, and it turns on `ode` |
//!
//! With `default-features = false` all other modules build without ODE: cameras, images, silhouettes, the hull and its
//! contacts.
//!
//! # Conventions
//!
//! | | |
//! |---|---|
//! | units | metres, kilograms, seconds, radians; images in pixels |
//! | world | right-handed; z is up by default, any gravity works |
//! | camera axes | x right, y down, z forward |
//! | transforms | `cam_from_world` maps world to camera: `x_cam = R x_world + t` |
//! | image coordinates | `(u, v)` from the upper-left *corner*; pixel `(i, j)` covers `[i, i+1) x [j, j+1)`, its centre is at `(i + 0.5, j + 0.5)` |
//! | projection matrix | 3x4, world to image, its third component the depth in metres |
//! | mask | a byte a pixel, 0 background to 255 subject; inside from 128 on, the values between are coverage |
//! | contact | `position` on the body's sample, `normal` into the first geom, `depth >= 0` |
//!
//! # A ball on a table that is only seen
//!
//! Four cameras look along the top of a table; their silhouettes are all that the simulation is given.
//!
#![cfg_attr(feature = "ode", doc = "```")]
#![cfg_attr(not(feature = "ode"), doc = "```ignore")]
//! use nalgebra::{Isometry3, Point3, Vector3};
//! use ode_visual_hull::hull::{Aabb, HullData};
//! use ode_visual_hull::ode::{Amount, Mass, Ode, Shape, Surface, World};
//! use ode_visual_hull::synthetic::{Texture, Placed, Solid, Subject, layout, silhouette};
//! use std::sync::Arc;
//!
//! # fn main() -> ode_visual_hull::Result<()> {
//! // The studio: a table 0.4 m high, its top at z = 0.2 m, and what the cameras see of it.
//! let sides = Vector3::new(0.5, 0.5, 0.4);
//! let table = Placed::new(Solid::cuboid(sides)?, Isometry3::identity(), Texture::plain([200, 60, 40]));
//! let table = Subject::new(vec![table]);
//! let data = Arc::new(HullData::new());
//! data.set_bounds(Aabb::new(Point3::new(-0.6, -0.6, -0.3), Point3::new(0.6, 0.6, 0.8))?)?;
//! for camera in layout::face_on(sides, &Isometry3::identity(), 2.8, 0.2, (320, 240), 0.45)? {
//!     let mask = silhouette(&camera, &table);
//!     let view = data.add_view(camera)?;
//!     data.set_mask(view, &mask)?;
//! }
//! data.update(0.0)?;
//!
//! // The simulation: an ODE world with the hull in it, and a ball above.
//! let mut world = World::new(&Ode::init()?)?;
//! world.set_gravity(&Vector3::new(0.0, 0.0, -9.81))?;
//! let root = world.root_space();
//! world.add_hull(root, &data)?;
//! let ball = Shape::Sphere { radius: 0.1 };
//! let (body, geom) = (world.add_body(), world.add_geom(root, &ball)?);
//! world.body_mut(body).set_mass(&Mass::of(&ball, Amount::Total(1.0))?)?;
//! world.body_mut(body).set_pose(&Isometry3::translation(0.0, 0.0, 0.32))?;
//! world.geom_mut(geom).set_body(Some(body))?;
//!
//! for _ in 0..100 {
//!     world.default_collide(&Surface::default(), 8)?;
//!     world.quick_step(0.005)?;
//! }
//! let height = world.body(body).position().z;
//! assert!((height - 0.3).abs() < 0.005, "a pixel covers 4 mm here: {height}");
//! # Ok(())
//! # }
//! ```
#![cfg_attr(not(feature = "ode"), doc = "\n[`ode`]: #features")]
#![deny(unsafe_code)]

pub mod camera;
#[cfg(feature = "ode")]
mod capi;
pub mod contact;
mod error;
pub mod hull;
mod image_file;
mod lock;
mod math;
#[cfg(feature = "ode")]
pub mod ode;
pub mod pipeline;
pub mod recording;
mod recycle;
pub mod rig;
pub mod sample;
pub mod segment;
pub mod shape;
mod side_by_side;
pub mod silhouette;
pub mod source;
pub mod synthetic;

pub use error::{Error, MissingHint, Result};

#[cfg(all(doctest, feature = "ode"))]
#[doc = include_str!("../README.md")]
mod readme {}
