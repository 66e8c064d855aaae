//! One body that sticks to the hull: where it is beside the part of the subject that it touched, and the velocity that keeps it
//! there.

use super::query::CollideContext;
use crate::hull::{Aabb, Followed, Motion, RigidMotion, Track};
use crate::ode::convert;
use crate::ode::slip::free_velocity;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use ode_sys::{
    dBodyEnable, dBodyGetAngularVel, dBodyGetLinearVel, dBodyGetPosition, dBodyGetQuaternion, dBodyID,
    dBodyIsEnabled, dBodySetAngularVel, dBodySetLinearVel, dGeomID, dReal,
};

/// The time in which the distance of a body from its place falls to a third, in seconds: it is spread over steps, as frames that
/// jump and noise need it. The body is off by what its velocity is wrong, times this: 5 mm where a hand that moves at 2 m/s stops
/// at once to brake.
const CORRECTION_SECONDS: f64 = 0.01;

/// A body that something holds back farther than this from its place, in metres, for the time in seconds, is released.
const HELD_BACK: f64 = 0.15;
const HELD_BACK_SECONDS: f64 = 0.1;

/// A body farther than this from where its velocity has taken it, in metres, was moved by the program, or is another one at the
/// same address.
const MOVED: f64 = 0.1;

/// The longest step in which a body moves by its velocity before it is collided again, in seconds.
const LONGEST_STEP: f64 = 0.05;

/// The time in seconds over which a body stays paired with the hull while the hull's box is not made anew.
const REACH_SECONDS: f64 = 0.1;

/// A body that sticks to a hull.
#[derive(Debug)]
pub(super) struct HeldBody {
    track: Track,
    /// The [`CollideContext::frame`] in which the part was followed last.
    frame: u64,
    /// The body's pose from the part's.
    part_from_body: Isometry3<f64>,
    /// Where the body was when it was carried last, and the velocity that it was given.
    position: Point3<f64>,
    velocity: Vector3<f64>,
    /// The time that has passed in steps since the frame, in seconds.
    since_frame: f64,
    /// For how long the body has been held back, in seconds.
    held_back: f64,
    is_released: bool,
    /// A box around it, in the world's frame.
    around: Aabb,
    /// Frames or collides since it was carried.
    count: u32,
}

/// What has become of a body in a collide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Carried {
    /// It sticks.
    Held,
    /// It was released.
    Released,
    /// Something holds it back.
    HeldBack,
    /// The program has moved it, or it is another one.
    Moved,
    /// The subject is not seen any more where it touched.
    Lost,
}

impl Carried {
    /// What a program is told of a body that does not stick any more, though it was not released.
    pub(super) fn reason(self) -> Option<String> {
        match self {
            Self::Held | Self::Released => None,
            Self::HeldBack => Some(format!(
                "found one that something has held back by more than {HELD_BACK} m for {HELD_BACK_SECONDS} s: it was \
                 released"
            )),
            Self::Moved => Some(format!(
                "found it more than {MOVED} m from where its velocity has taken it: it was moved, or is another body, and \
                 was released as it is"
            )),
            Self::Lost => Some(
                "found no edges of silhouettes for 0.2 s by which the hull at it is followed: it was released at its last \
                 velocity"
                    .into(),
            ),
        }
    }
}

impl HeldBody {
    /// A body that touches the part that `track` follows.
    ///
    /// # Safety
    /// `body` is living.
    pub(super) unsafe fn new(body: dBodyID, track: Track, context: &CollideContext) -> Self {
        // SAFETY: the caller vouches for the body.
        let (pose, velocity) = unsafe { (pose_of(body), velocity_of(body).linear) };
        let part_from_body = track.pose().inverse() * context.hull_from_world * pose;
        Self {
            track,
            frame: context.frame,
            part_from_body,
            position: pose.translation.vector.into(),
            velocity,
            since_frame: 0.0,
            held_back: 0.0,
            is_released: false,
            around: Aabb::EMPTY,
            count: 0,
        }
    }

    /// Whether it has not been released.
    pub(super) fn is_held(&self) -> bool {
        !self.is_released
    }

    /// Releases it in the next collide.
    pub(super) fn release(&mut self) {
        self.is_released = true;
    }

    /// Counts a frame or a collide of other bodies, and returns how many there were since it was carried.
    pub(super) fn count(&mut self) -> u32 {
        self.count += 1;
        self.count
    }

    /// A box around it and where it may be soon, in the world's frame.
    pub(super) fn reach(&self) -> Aabb {
        self.around.grown(self.velocity.norm() * REACH_SECONDS)
    }

    /// Gives `body` the velocity that takes it to its place in the next step; where it is to be released, that of the subject.
    /// A body of which several geoms are collided in one step gets the same velocity again.
    ///
    /// # Safety
    /// `body` is living, and so is `other`, a geom of it.
    pub(super) unsafe fn carry(
        &mut self,
        body: dBodyID,
        other: dGeomID,
        context: &CollideContext,
    ) -> Carried {
        // SAFETY: the caller vouches for the body.
        let pose = unsafe { pose_of(body) };
        let position = Point3::from(pose.translation.vector);
        // SAFETY: as above, for the geom.
        self.around = unsafe { convert::aabb_of(other) };
        self.count = 0;

        let way = position - self.position;
        // Not a number is nowhere near.
        let is_near = way.norm() <= MOVED + self.velocity.norm() * LONGEST_STEP;
        if !is_near {
            return if self.is_released { Carried::Released } else { Carried::Moved };
        }
        context.geom.step_size.see(body as usize, position, &self.velocity);
        let seconds = context.geom.step_size.seconds().unwrap_or(0.0);
        // Several geoms of a body are collided in one step.
        let is_same_step = way == Vector3::zeros() && context.frame == self.frame;
        let passed = if is_same_step { 0.0 } else { seconds };
        let followed = self.follow(context, passed);

        let (place, motion) = self.place(context);
        let off = Difference::between(&place, &pose);
        if self.is_released || followed == Followed::Lost {
            // SAFETY: the caller vouches for the body.
            unsafe { set_velocity(body, &self.last_motion(context, &position)) };
            return if self.is_released { Carried::Released } else { Carried::Lost };
        }
        self.held_back = if off.shift.norm() > HELD_BACK { self.held_back + passed } else { 0.0 };
        if self.held_back > HELD_BACK_SECONDS {
            return Carried::HeldBack;
        }

        let corrected = if seconds > 0.0 { 1.0 - (-seconds / CORRECTION_SECONDS).exp() } else { 0.0 };
        let gain = if seconds > 0.0 { corrected / seconds } else { 0.0 };
        let linear = motion.linear + off.shift * gain;
        let angular = motion.angular + off.turn * gain;
        // SAFETY: the caller vouches for the body.
        unsafe {
            // What gravity and the program's forces will add in the step.
            let gained = free_velocity(body, &position, seconds) - velocity_of(body).linear;
            set_velocity(body, &RigidMotion { linear: linear - gained, angular });
            if dBodyIsEnabled(body) == 0 {
                dBodyEnable(body);
            }
        }
        (self.position, self.velocity) = (position, linear);
        Carried::Held
    }

    /// Follows the part to the frame in force, `passed` seconds after the last step.
    fn follow(&mut self, context: &CollideContext, passed: f64) -> Followed {
        if context.frame == self.frame {
            self.since_frame += passed;
            return Followed::Found;
        }
        (self.frame, self.since_frame) = (context.frame, 0.0);
        self.track.follow(&context.hull)
    }

    /// Where the body belongs, in the world, and how it moves there.
    ///
    /// A hull that is held shows the subject as it was at the frame, and the subject goes on: so does the body, for as long as
    /// the last frame took. One in motion shows it as it is, and stands still where the next frame is late.
    fn place(&self, context: &CollideContext) -> (Isometry3<f64>, RigidMotion) {
        let motion = self.track.motion();
        let (ahead, is_moving) = if context.motion == Motion::Held {
            let period = self.track.period();
            (self.since_frame.min(period), self.since_frame < period)
        } else {
            (0.0, !self.track.stands_still())
        };

        let part = motion.advance(self.track.pose(), &self.track.place(), ahead);
        let body = part * self.part_from_body;
        let centre = self.track.place() + motion.linear * ahead;
        let motion = if is_moving { motion } else { RigidMotion::REST };
        let motion = motion.at(&(body.translation.vector - centre.coords));
        let world_from_hull = context.hull_from_world.inverse();
        (world_from_hull * body, motion.turned(&world_from_hull.rotation))
    }

    /// How the part moves at a place in the world.
    fn last_motion(&self, context: &CollideContext, position: &Point3<f64>) -> RigidMotion {
        let arm = context.hull_from_world * position - self.track.place();
        self.track.motion().at(&arm).turned(&context.hull_from_world.rotation.inverse())
    }
}

/// The shift and the turn from one pose to another.
struct Difference {
    shift: Vector3<f64>,
    turn: Vector3<f64>,
}

impl Difference {
    fn between(to: &Isometry3<f64>, from: &Isometry3<f64>) -> Self {
        let turn = (to.rotation * from.rotation.inverse()).scaled_axis();
        Self { shift: to.translation.vector - from.translation.vector, turn }
    }
}

/// The pose of a body.
///
/// # Safety
/// `body` is living.
unsafe fn pose_of(body: dBodyID) -> Isometry3<f64> {
    // SAFETY: the caller vouches for the body, whose position has three numbers and whose quaternion has four.
    unsafe {
        let (position, quaternion): (*const dReal, *const dReal) =
            (dBodyGetPosition(body), dBodyGetQuaternion(body));
        let rotation: UnitQuaternion<f64> = convert::rotation(&quaternion.cast::<[dReal; 4]>().read());
        Isometry3::from_parts(convert::vector_at(position).into(), rotation)
    }
}

/// The velocity of a body.
///
/// # Safety
/// `body` is living.
unsafe fn velocity_of(body: dBodyID) -> RigidMotion {
    // SAFETY: the caller vouches for the body, whose velocities have three numbers.
    unsafe {
        let (linear, angular): (*const dReal, *const dReal) =
            (dBodyGetLinearVel(body), dBodyGetAngularVel(body));
        RigidMotion { linear: convert::vector_at(linear), angular: convert::vector_at(angular) }
    }
}

/// Sets the velocity of a body.
///
/// # Safety
/// `body` is living.
unsafe fn set_velocity(body: dBodyID, RigidMotion { linear, angular }: &RigidMotion) {
    // SAFETY: the caller vouches for the body; setting a velocity touches no space.
    unsafe {
        dBodySetLinearVel(body, linear.x, linear.y, linear.z);
        dBodySetAngularVel(body, angular.x, angular.y, angular.z);
    }
}
