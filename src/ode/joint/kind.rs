//! The kinds of joint: what each one needs, and which bodies and axes it has.

use nalgebra::{Point3, Vector3};

use crate::ode::arena::BodyId;
use crate::ode::check;
use crate::ode::contacts::ContactGeom;
use crate::ode::surface::Surface;
use crate::{Error, Result};

use super::motor::{self, MotorAxis};

/// The largest cosine of the angle between two axes that count as perpendicular.
const PERPENDICULAR: f64 = 1e-3;

/// The description of a joint to create: its kind and its geometry in the world's frame.
///
/// Axes may have any length but 0. Angles and positions are 0 at the bodies' current poses.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum JointKind {
    /// A ball-and-socket joint: both bodies share a point.
    Ball {
        /// The shared point.
        anchor: Point3<f64>,
    },
    /// Both bodies share an axis and rotate about it.
    Hinge {
        /// A point on the axis.
        anchor: Point3<f64>,
        /// The direction of the axis.
        axis: Vector3<f64>,
    },
    /// Both bodies keep their relative rotation and slide along an axis.
    Slider {
        /// The direction of the axis.
        axis: Vector3<f64>,
    },
    /// Both bodies keep their current relative pose.
    Fixed,
    /// A contact that keeps the bodies from moving into each other at a point. It lasts until it is removed.
    Contact {
        /// The point, normal and depth of the contact. The normal points into the first body.
        contact: ContactGeom,
        /// Friction, bounce and softness of the contact.
        surface: Surface,
    },
    /// Two hinges in series, as between the chassis (first body) and a steered wheel (second body). It needs two
    /// bodies. Along the first axis it can be soft, as a suspension is: see
    /// [`SuspensionErp`](super::JointParam::SuspensionErp).
    Hinge2 {
        /// The point where the axes meet.
        anchor: Point3<f64>,
        /// The steering axis, fixed to the first body, and the wheel's axis, fixed to the second; not parallel.
        axes: [Vector3<f64>; 2],
    },
    /// A universal (Cardan) joint: a hinge on each body, and the two axes stay perpendicular. The first body must not
    /// be the world.
    Universal {
        /// The point where the axes meet.
        anchor: Point3<f64>,
        /// The axis fixed to the first body, and the one fixed to the second; perpendicular.
        axes: [Vector3<f64>; 2],
    },
    /// A slider and a hinge in series (ODE's PR joint). The first body must not be the world.
    PrismaticRotoide {
        /// A point on the hinge's axis, fixed to the second body.
        anchor: Point3<f64>,
        /// The slider's axis and the hinge's, both fixed to the first body; perpendicular.
        axes: [Vector3<f64>; 2],
    },
    /// A universal joint and a slider in series (ODE's PU joint). The first body must not be the
    /// world.
    PrismaticUniversal {
        /// The point where the axes meet, fixed to the second body.
        anchor: Point3<f64>,
        /// The universal joint's axes, the first fixed to the first body and the second to the second, perpendicular;
        /// then the slider's axis, fixed to the first body.
        axes: [Vector3<f64>; 3],
    },
    /// Both bodies share an axis, slide along it and rotate about it. The first body must not be the world.
    Piston {
        /// A point on the axis.
        anchor: Point3<f64>,
        /// The direction of the axis.
        axis: Vector3<f64>,
    },
    /// Drives the relative velocity of two bodies along up to three axes. The first body must not be the world.
    LinearMotor {
        /// The axes; those that are used come first.
        axes: [Option<MotorAxis>; 3],
    },
    /// Drives the relative angular velocity of two bodies about up to three axes (ODE's angular motor in user mode).
    /// The first body must not be the world.
    AngularMotor {
        /// The axes; those that are used come first.
        axes: [Option<MotorAxis>; 3],
    },
    /// Drives and limits the three Euler angles between two bodies, as for a ball joint with stops (ODE's angular motor
    /// in Euler mode). The first body must not be the world.
    EulerMotor {
        /// The axis of the first angle, fixed to the first body, and that of the third, fixed to the second body;
        /// perpendicular. The second angle's axis is perpendicular to both.
        axes: [Vector3<f64>; 2],
    },
    /// Keeps a body in the plane z = 0 of the world, with rotations about z alone. Its parameters belong to motors
    /// along x and y and about z. The bodies are `[Some(body), None]`.
    Plane2d,
}

/// The kind of an existing joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[allow(missing_docs, reason = "see `JointKind`")]
pub enum JointType {
    Ball,
    Hinge,
    Slider,
    Fixed,
    Contact,
    Hinge2,
    Universal,
    PrismaticRotoide,
    PrismaticUniversal,
    Piston,
    LinearMotor,
    AngularMotor,
    EulerMotor,
    Plane2d,
}

/// An axis of a joint by its number. Which axis is which is described at [`JointKind`], where they are in this order.
///
/// A piston's first axis stands for sliding and its second for rotating, although both are one line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs, reason = "the names say it")]
pub enum JointAxis {
    First,
    Second,
    Third,
}

/// The motion that an axis of a joint allows, drives or limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    Rotation,
    Translation,
}

impl JointAxis {
    /// All axes, in order.
    pub const ALL: [Self; 3] = [Self::First, Self::Second, Self::Third];

    /// The axis' number, from 0.
    pub(super) fn index(self) -> usize {
        self as usize
    }
}

impl JointType {
    /// The motions of the joint's axes, in order. A motor may use fewer axes.
    pub(super) fn motions(self) -> &'static [Motion] {
        use Motion::{Rotation, Translation};
        match self {
            Self::Ball | Self::Fixed | Self::Contact => &[],
            Self::Hinge => &[Rotation],
            Self::Slider => &[Translation],
            Self::Hinge2 | Self::Universal => &[Rotation, Rotation],
            Self::PrismaticRotoide | Self::Piston => &[Translation, Rotation],
            Self::PrismaticUniversal => &[Rotation, Rotation, Translation],
            Self::LinearMotor => &[Translation; 3],
            Self::AngularMotor | Self::EulerMotor => &[Rotation; 3],
            Self::Plane2d => &[Translation, Translation, Rotation],
        }
    }

    /// Refuses bodies that ODE aborts on with this kind of joint, or handles wrongly: with the world as their first
    /// body, ODE pushes the bodies of pistons and PR joints away, and mixes up the signs, axes or parameters of the
    /// others below.
    pub(super) fn check_bodies(self, bodies: [Option<BodyId>; 2]) -> Result<()> {
        let (expected, action) = match (self, bodies) {
            (Self::Ball | Self::Hinge | Self::Slider | Self::Fixed | Self::Contact, _) => return Ok(()),
            (Self::Hinge2, [Some(_), Some(_)]) | (Self::Plane2d, [Some(_), None]) => return Ok(()),
            (Self::Hinge2, _) => ("two bodies", "add a kinematic body in place of the world"),
            (Self::Plane2d, _) => ("one body and then the world", "pass `[Some(body), None]`"),
            (_, [Some(_), _]) => return Ok(()),
            (_, [None, _]) => {
                ("a body before the world", "swap the two, which changes the signs of angles and positions")
            }
        };
        Err(Error::argument(format!("{self:?} joint: expected {expected}, found {bodies:?}; {action}")))
    }
}

impl JointKind {
    /// The kind of the joint, without its geometry.
    pub fn joint_type(&self) -> JointType {
        match self {
            Self::Ball { .. } => JointType::Ball,
            Self::Hinge { .. } => JointType::Hinge,
            Self::Slider { .. } => JointType::Slider,
            Self::Fixed => JointType::Fixed,
            Self::Contact { .. } => JointType::Contact,
            Self::Hinge2 { .. } => JointType::Hinge2,
            Self::Universal { .. } => JointType::Universal,
            Self::PrismaticRotoide { .. } => JointType::PrismaticRotoide,
            Self::PrismaticUniversal { .. } => JointType::PrismaticUniversal,
            Self::Piston { .. } => JointType::Piston,
            Self::LinearMotor { .. } => JointType::LinearMotor,
            Self::AngularMotor { .. } => JointType::AngularMotor,
            Self::EulerMotor { .. } => JointType::EulerMotor,
            Self::Plane2d => JointType::Plane2d,
        }
    }

    /// The anchor, of the kinds that have one.
    pub(super) fn anchor(&self) -> Option<Point3<f64>> {
        match *self {
            Self::Ball { anchor }
            | Self::Hinge { anchor, .. }
            | Self::Hinge2 { anchor, .. }
            | Self::Universal { anchor, .. }
            | Self::PrismaticRotoide { anchor, .. }
            | Self::PrismaticUniversal { anchor, .. }
            | Self::Piston { anchor, .. } => Some(anchor),
            _ => None,
        }
    }

    /// The axes that are vectors of the world's frame, in order; empty for kinds without, and for motors.
    pub(super) fn axes(&self) -> &[Vector3<f64>] {
        match self {
            Self::Hinge { axis, .. } | Self::Slider { axis } | Self::Piston { axis, .. } => {
                std::slice::from_ref(axis)
            }
            Self::Hinge2 { axes, .. }
            | Self::Universal { axes, .. }
            | Self::PrismaticRotoide { axes, .. }
            | Self::EulerMotor { axes } => axes,
            Self::PrismaticUniversal { axes, .. } => axes,
            _ => &[],
        }
    }

    /// Refuses bodies that the kind cannot connect, and geometry that ODE aborts on or cannot solve.
    pub(super) fn check(&self, bodies: [Option<BodyId>; 2]) -> Result<()> {
        self.joint_type().check_bodies(bodies)?;
        if let Some(anchor) = self.anchor() {
            check::point("anchor of the joint", &anchor)?;
        }
        if let Self::LinearMotor { axes } | Self::AngularMotor { axes } = self {
            motor::check_axes(axes, bodies[1].is_some())?;
        }
        check_axes(self.joint_type(), self.axes()).map(|_| ())
    }
}

/// The axes as unit vectors, with zeros where there are fewer than three.
///
/// # Errors
///
/// [`Error::Argument`] for numbers that are not finite, lengths of 0, and angles between axes that the kind of joint
/// cannot have.
pub(super) fn check_axes(kind: JointType, axes: &[Vector3<f64>]) -> Result<[Vector3<f64>; 3]> {
    let mut units = [Vector3::zeros(); 3];
    for (unit, axis) in units.iter_mut().zip(axes) {
        *unit = check::direction("axis of the joint", axis)?.into_inner();
    }

    let (sine, cosine) = (units[0].cross(&units[1]).norm(), units[0].dot(&units[1]).abs());
    let (expected, valid) = match kind {
        JointType::Hinge2 => ("that are not parallel", sine >= PERPENDICULAR),
        JointType::Universal
        | JointType::PrismaticRotoide
        | JointType::PrismaticUniversal
        | JointType::EulerMotor => ("perpendicular to each other", cosine <= PERPENDICULAR),
        _ => return Ok(units),
    };
    if valid {
        return Ok(units);
    }
    let degrees = sine.atan2(cosine).to_degrees();
    Err(Error::argument(format!(
        "axes of the {kind:?} joint: expected two axes {expected}, found an angle of {degrees} degrees"
    )))
}
