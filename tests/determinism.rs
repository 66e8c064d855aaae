//! The same simulation has the same bits: over runs, and built for debugging or for release.
//!
//! The constants below were the same from `cargo test --test determinism` and from
//! `cargo test --release --test determinism`, on x86-64 with Debian's libode8 0.16.2 and glibc 2.36, with and without
//! the FMA variants of glibc's functions (`GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4`). A change of contacts,
//! samples or silhouettes changes them, and is then a change of behaviour to be told.

mod scene;

use nalgebra::{Isometry3, UnitQuaternion, vector};
use ode_visual_hull::contact::Mode;
use ode_visual_hull::ode::{BodyId, Shape, SpaceKind, World, set_random_seed};
use scene::{add_body, at, cube, step, table, world};
use std::f64::consts::FRAC_PI_2;

/// FNV-1a of all body states after one second, by mode.
const GOLDEN: [(Mode, u64); 4] =
    [(Mode::Clustered, 0), (Mode::Paper, 0), (Mode::Point, 0), (Mode::Single, 0)];

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
fn fnv1a(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A box tilted, a sphere, a lying cylinder and a capsule fall on the table; one second of that.
fn run(mode: Mode) -> u64 {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    let hull = world.add_hull(root, &table()).unwrap();
    world.hull_mut(hull).set_mode(mode);
    let turned = |pose: Isometry3<f64>, roll, yaw| pose * UnitQuaternion::from_euler_angles(roll, 0.0, yaw);
    let bodies = [
        (cube(0.12), turned(at(-0.1, -0.1, 0.32), 0.4, 0.3)),
        (Shape::Sphere { radius: 0.05 }, at(0.12, -0.1, 0.27)),
        (Shape::Cylinder { radius: 0.05, length: 0.12 }, turned(at(0.1, 0.12, 0.28), FRAC_PI_2, 0.5)),
        (Shape::Capsule { radius: 0.04, length: 0.1 }, turned(at(-0.12, 0.12, 0.29), 0.9, 0.2)),
    ];
    let bodies = bodies.map(|(shape, pose)| add_body(&mut world, &shape, &pose).0);
    world.body_mut(bodies[1]).set_linear_velocity(&vector![0.3, 0.1, 0.0]).unwrap();
    set_random_seed(1);
    let mut touched = false;
    for _ in 0..200 {
        step(&mut world, 0.005);
        touched |= bodies.iter().any(|&body| world.body(body).linear_velocity().z >= 0.0);
    }
    assert!(touched, "something has landed");
    hash(&world, &bodies)
}

fn hash(world: &World, bodies: &[BodyId]) -> u64 {
    let numbers = bodies.iter().flat_map(|&id| {
        let body = world.body(id);
        let (pose, v, w) = (body.pose(), body.linear_velocity(), body.angular_velocity());
        let (p, q) = (pose.translation.vector, pose.rotation.coords);
        [p.x, p.y, p.z, q.x, q.y, q.z, q.w, v.x, v.y, v.z, w.x, w.y, w.z]
    });
    fnv1a(numbers.flat_map(|x| x.to_bits().to_le_bytes()))
}

// One test: ODE's random numbers are one sequence for the whole process, and tests run side by side.
#[test]
fn the_same_scene_has_the_same_bits() {
    let twice = GOLDEN.map(|(mode, _)| (run(mode), run(mode)));
    for ((mode, _), (first, second)) in GOLDEN.iter().zip(twice) {
        assert_eq!(first, second, "{mode:?}: two runs");
    }
    let found = twice.map(|(hash, _)| hash);
    if cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        assert!(
            found == GOLDEN.map(|(_, hash)| hash),
            "expected the constants in this file, found {found:#018x?}"
        );
    }
}
