//! A simulation has equal bits in each run, in each process, and in debug and release builds.
//!
//! The expected numbers are hashes of the bits of all states of a scene. Floating point is IEEE 754, and no computation
//! of a contact uses fused or reordered arithmetic, so that they hold in both profiles. They were recorded in one
//! profile and confirmed in the other, and with glibc's FMA variants switched off
//! (`GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4`). A change of these numbers is a change of behaviour, which
//! needs a "Behaviour" line in the changelog.

use nalgebra::UnitQuaternion;
use ode_visual_hull::contact::Mode;
use ode_visual_hull::ode::{Shape, SpaceKind, set_random_seed};
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;

/// FNV-1a hash of the bits.
fn hash(numbers: impl Iterator<Item = f64>) -> u64 {
    let bytes = numbers.flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// The hash of a scene in which a tilted box, a ball and a lying cylinder fall on the table and on one another.
fn fall(mode: Mode) -> u64 {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    let hull = world.add_hull(root, &table()).unwrap();
    world.hull_mut(hull).set_mode(mode);

    let tilted = at(0.05, 0.0, TOP + 0.2) * UnitQuaternion::from_euler_angles(0.3, 0.4, 0.5);
    let lying = at(-0.1, 0.05, TOP + 0.3) * UnitQuaternion::from_euler_angles(1.5, 0.1, 0.0);
    let bodies = [
        add_body(&mut world, &cube(0.15), &tilted).0,
        add_body(&mut world, &Shape::Sphere { radius: 0.06 }, &at(0.06, 0.02, TOP + 0.45)).0,
        add_body(&mut world, &Shape::Cylinder { radius: 0.05, length: 0.15 }, &lying).0,
    ];

    set_random_seed(7);
    let mut states = Vec::new();

    for _ in 0..200 {
        step(&mut world, 0.005);
        for &body in &bodies {
            let body = world.body(body);
            states.extend(body.position().iter().chain(body.linear_velocity().iter()).copied());
            states.extend(body.angular_velocity().iter().copied());
        }
    }

    hash(states.into_iter())
}

#[test]
fn a_scene_has_the_same_bits_in_every_run_and_profile() {
    let golden = [
        (Mode::Clustered, 0x3ff9_5640_4242_460c),
        (Mode::Paper, 0x17e6_850f_f7a3_b9f3),
        (Mode::Point, 0x2fa5_72a9_b241_f28f),
        (Mode::Single, 0xce71_134d_64e7_03cf),
    ];
    let found: Vec<(Mode, u64)> = golden.iter().map(|&(mode, _)| (mode, fall(mode))).collect();
    let again: Vec<(Mode, u64)> = golden.iter().map(|&(mode, _)| (mode, fall(mode))).collect();
    assert_eq!(found, again, "two runs in one process");
    assert_eq!(found, golden, "{:#x?}", found.iter().map(|(_, hash)| hash).collect::<Vec<_>>());
}
