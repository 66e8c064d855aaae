//! Random calls of every function of joints, valid and invalid, with steps in between: each ends in a result, and
//! none in an abort of ODE.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{
    AxisFrame, BodyId, ContactGeom, JointAxis, JointGroupId, JointId, JointKind, JointParam, MotorAxis,
    Shape, Surface, World,
};
use ode_visual_hull_random::Random;

use crate::{add, add_ground, world};

const SEEDS: u64 = 100;
const CALLS: usize = 300;

const PARAMS: [JointParam; 12] = [
    JointParam::LowStop,
    JointParam::HighStop,
    JointParam::MotorVelocity,
    JointParam::MotorMaxForce,
    JointParam::FudgeFactor,
    JointParam::Bounce,
    JointParam::Cfm,
    JointParam::Erp,
    JointParam::StopErp,
    JointParam::StopCfm,
    JointParam::SuspensionErp,
    JointParam::SuspensionCfm,
];

/// A scene, and ids of all that ever was in it: also of what was removed.
struct Scene {
    random: Random,
    world: World,
    bodies: Vec<BodyId>,
    joints: Vec<JointId>,
    groups: Vec<JointGroupId>,
    steps: usize,
}

#[test]
fn no_order_of_calls_makes_ode_abort() {
    let mut steps = 0;
    for seed in 0..SEEDS {
        let mut scene = Scene::new(seed);
        for _ in 0..CALLS {
            scene.call();
        }
        steps += scene.steps;
    }
    // A scene that no longer steps would test little.
    assert!(steps > SEEDS as usize * CALLS / 10, "{steps}");
}

impl Scene {
    fn new(seed: u64) -> Self {
        let mut world = world();
        add_ground(&mut world);
        let groups = vec![world.add_joint_group()];
        let (random, bodies, joints) = (Random(seed), Vec::new(), Vec::new());
        Self { random, world, bodies, joints, groups, steps: 0 }
    }

    fn call(&mut self) {
        match self.random.below(20) {
            0..3 => self.step(),
            3..6 => self.change_body(),
            6..9 => self.add_joint(),
            9 => self.remove(),
            10 => self.read(),
            _ => self.change_joint(),
        }
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.random.below(choices.len())]
    }

    /// A number, often an extreme one.
    fn number(&mut self) -> f64 {
        let any = self.random.between(-3.0, 3.0);
        self.one_of(&[
            any,
            any,
            any,
            0.0,
            1.0,
            1e-9,
            1e9,
            -1e30,
            1e30,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
        ])
    }

    /// A direction, often along an axis of the world.
    fn direction(&mut self) -> Vector3<f64> {
        let (any, length) = (self.random.direction(), self.random.between(0.1, 3.0));
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        self.one_of(&[
            any,
            any * length,
            x,
            y,
            z,
            -x,
            -y,
            -z,
            Vector3::zeros(),
            Vector3::new(0.0, f64::NAN, 1.0),
        ])
    }

    fn directions<const N: usize>(&mut self) -> [Vector3<f64>; N] {
        // Mostly the axes of a frame, which joints accept.
        let frame = self.rotation();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let turned = self.random.unit() < 0.8;
        std::array::from_fn(|i| if turned { frame * axes[i] } else { self.direction() })
    }

    /// A rotation, often one that maps axes onto each other without a rounding error.
    fn rotation(&mut self) -> UnitQuaternion<f64> {
        let any = self.random.rotation();
        let third = |s| UnitQuaternion::new_unchecked(Quaternion::new(0.5, 0.5 * s, 0.5 * s, 0.5 * s));
        let half = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, 0.0, 0.0));
        self.one_of(&[any, any, UnitQuaternion::identity(), third(1.0), third(-1.0), half])
    }

    fn point(&mut self) -> Point3<f64> {
        let size = self.one_of(&[0.0, 1.0, 1.0, 1.0, 1e3, 1e7, f64::NAN]);
        Point3::from(self.random.direction() * size)
    }

    fn pair(&mut self) -> [Option<BodyId>; 2] {
        // Recent bodies are likely to exist.
        let recent = self.bodies.len().saturating_sub(6);
        let mut body = || {
            let id = self.bodies.get(recent + self.random.below(6_usize)).copied();
            if self.random.unit() < 0.75 { id } else { None }
        };
        [body(), body()]
    }

    fn motor_axes(&mut self) -> [Option<MotorAxis>; 3] {
        let count = self.random.below(4_usize);
        std::array::from_fn(|i| {
            let frame = self.one_of(&[AxisFrame::World, AxisFrame::FirstBody, AxisFrame::SecondBody]);
            let axis = MotorAxis { direction: self.direction(), frame };
            (i < count || self.random.unit() < 0.05).then_some(axis)
        })
    }

    fn surface(&mut self, normal: &Vector3<f64>) -> Surface {
        let tangent = normal.cross(&self.random.direction()).normalize();
        let directed = self.random.unit() < 0.7;
        Surface {
            mu: self.one_of(&[0.0, 0.5, f64::INFINITY]),
            mu2: self.one_of(&[None, Some(0.0), Some(1.0)]),
            friction_direction: directed.then_some(tangent),
            surface_velocity: self.one_of(&[None, Some([0.5, -1.0]), Some([1e30, 0.0])]),
            normal_velocity: self.one_of(&[None, Some(0.1), Some(-1e30)]),
            rolling: self.one_of(&[None, Some(0.0), Some(0.1)]),
            ..Surface::default()
        }
    }

    fn step(&mut self) {
        let measured = self.random.unit() < 0.5;
        let tangents: [Surface; 2] = std::array::from_fn(|_| self.surface(&Vector3::z()));
        // The surfaces may be invalid at these contacts, and bodies may leave the world: errors are results, too.
        let _ = self.world.collide(|pair| {
            for (contact, surface) in pair.contacts(4).iter().zip(tangents.iter().cycle()) {
                if measured { pair.attach_measured(contact, surface) } else { pair.attach(contact, surface) }
            }
        });
        let dt = self.one_of(&[0.001, 0.01, 0.01, 1.0]);
        let stepped = if self.random.unit() < 0.5 { self.world.step(dt) } else { self.world.quick_step(dt) };
        self.steps += usize::from(stepped.is_ok());
        assert!(self.world.contact_feedback().len() < 100);
    }

    fn change_body(&mut self) {
        let at: [f64; 3] = std::array::from_fn(|_| self.random.between(-1.0, 1.0));
        let living: Vec<_> = self.world.bodies().collect();
        if living.len() < 4 {
            let (size, mass) = (self.random.between(0.05, 0.5), self.one_of(&[1e-6, 1.0, 1e6]));
            self.bodies.push(add(&mut self.world, &Shape::cuboid(size, size, size), mass, at).0);
            return;
        }

        let (id, direction, rotation) = (self.one_of(&living), self.random.direction(), self.rotation());
        let number = self.random.between(-20.0, 20.0);
        let mut body = self.world.body_mut(id);
        match self.random.below(8) {
            0 => assert!(self.world.remove_body_and_geoms(id)),
            1 | 2 => {
                let at = self.one_of(&[Translation3::identity(), at.into()]);
                self.world.body_mut(id).set_pose(&Isometry3::from_parts(at, rotation)).unwrap();
            }
            3 => body.set_angular_velocity(&(direction * number)).unwrap(),
            4 => body.set_linear_velocity(&(direction * number)).unwrap(),
            5 => body.set_enabled(number > 0.0),
            6 => body.set_kinematic(number > 10.0),
            _ => body.add_force(&(direction * number.powi(5))).unwrap(),
        }
    }

    fn kind(&mut self) -> JointKind {
        let (anchor, axis) = (self.point(), self.direction());
        match self.random.below(14) {
            0 => JointKind::Ball { anchor },
            1 => JointKind::Hinge { anchor, axis },
            2 => JointKind::Slider { axis },
            3 => JointKind::Fixed,
            4 => {
                let (normal, geom) = (self.random.direction(), self.world.geoms().next().unwrap());
                let contact = ContactGeom {
                    position: anchor,
                    normal,
                    depth: self.number(),
                    time: 0.0,
                    geoms: [geom, geom],
                };
                JointKind::Contact { contact, surface: self.surface(&normal) }
            }
            5 | 6 => JointKind::Hinge2 { anchor, axes: self.directions() },
            7 => JointKind::Universal { anchor, axes: self.directions() },
            8 => JointKind::PrismaticRotoide { anchor, axes: self.directions() },
            9 => JointKind::PrismaticUniversal { anchor, axes: self.directions() },
            10 => JointKind::Piston { anchor, axis },
            11 => self.one_of(&[JointKind::Plane2d, JointKind::Fixed]),
            12 => JointKind::EulerMotor { axes: self.directions() },
            _ => {
                let axes = self.motor_axes();
                self.one_of(&[JointKind::LinearMotor { axes }, JointKind::AngularMotor { axes }])
            }
        }
    }

    fn add_joint(&mut self) {
        // Fewer joints than would lock all bodies.
        if self.world.joints().count() > 8 {
            return self.remove();
        }
        let (bodies, kind, group) = (self.pair(), self.kind(), self.random.below(2 * self.groups.len()));
        let joint = match self.groups.get(group) {
            Some(&group) => self.world.add_joint_in(group, bodies, &kind),
            None => self.world.add_joint(bodies, &kind),
        };
        self.joints.extend(joint.ok());
    }

    fn remove(&mut self) {
        let group = self.groups[self.groups.len() - 1];
        match self.random.below(8) {
            0 => self.world.empty_joint_group(group).unwrap(),
            1 => {
                assert!(self.world.remove_joint_group(group));
                self.groups = vec![self.world.add_joint_group()];
            }
            _ => {
                let joint = self.random.below(self.joints.len().max(1));
                self.joints.get(joint).map(|&joint| self.world.remove_joint(joint));
            }
        }
    }

    /// A joint that exists.
    fn joint(&mut self) -> Option<JointId> {
        let living: Vec<_> = self.world.joints().collect();
        (!living.is_empty()).then(|| self.one_of(&living))
    }

    fn change_joint(&mut self) {
        let Some(id) = self.joint() else { return };
        let (axis, number, direction) = (self.one_of(&JointAxis::ALL), self.number(), self.direction());
        let (anchor, pair, axes, motor_axes) =
            (self.point(), self.pair(), self.directions::<3>(), self.motor_axes());
        let (param, count) = (self.one_of(&PARAMS), self.random.below(4_usize));
        let mut joint = self.world.joint_mut(id);

        // Refusals are as good as successes.
        let _ = match self.random.below(13) {
            0 | 1 => joint.attach(pair),
            2 => joint.set_anchor(&anchor),
            3 => joint.set_axis(&direction),
            4 => joint.set_axes(&axes[..count]),
            5 => joint.set_motor_axes(&motor_axes),
            6 => joint.set_motor_angle(axis, number),
            7 => joint.add_torque(axis, number),
            8 => joint.add_force(number),
            9 => {
                joint.set_enabled(number >= 0.0);
                joint.set_feedback(count > 0);
                Ok(())
            }
            _ => joint.set_param_of_axis(axis, param, number),
        };
    }

    fn read(&mut self) {
        self.world.export_dif("/dev/null").unwrap();
        let Some(id) = self.joint() else { return };
        let joint = self.world.joint(id);
        let attached = joint.bodies() != [None, None];
        assert_eq!(joint.is_attached(), attached);
        let vectors = [joint.anchor(), joint.anchor2(), joint.axis().map(Point3::from)];
        assert!(attached || vectors == [None; 3]);
        assert!(vectors.iter().flatten().all(|vector| vector.iter().all(|number| number.is_finite())));

        let numbers = [joint.position(), joint.position_rate(), joint.angle(), joint.angle_rate()];
        assert!(attached || numbers == [None; 4]);
        for axis in JointAxis::ALL {
            let numbers = [joint.angle_of(axis), joint.angle_rate_of(axis)];
            assert!(attached || (joint.axis_of(axis), numbers) == (None, [None; 2]));
            assert!(
                PARAMS
                    .iter()
                    .all(|&param| joint.param_of_axis(axis, param).is_none_or(|value| !value.is_nan()))
            );
        }
        assert!(joint.feedback().is_none_or(|feedback| feedback.forces.len() == 2));
    }
}
