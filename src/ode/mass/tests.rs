//! Masses compared with ODE's own functions and with one another.

use std::sync::Arc;

use comparison::approx_eq;
use ode_sys::{
    dMassAdd, dMassAdjust, dMassRotate, dMassSetBox, dMassSetCapsule, dMassSetCylinder, dMassSetSphere,
};
use ode_sys::{dMassTranslate, dMatrix3};

use super::*;
use crate::ode::{Convex, TriMesh};

mod comparison {
    use super::super::Mass;

    /// Whether two masses are equal up to roundoff: both multiply the same few numbers in different orders.
    pub fn approx_eq(a: &Mass, b: &Mass) -> bool {
        let scale = a.inertia.norm();
        (a.total - b.total).abs() <= 1e-12 * a.total
            && (a.center - b.center).norm() <= 1e-12 * (1.0 + a.center.norm())
            && (a.inertia - b.inertia).norm() <= 1e-11 * scale
    }
}

/// The mass that one of ODE's own functions computes.
fn ode_mass(set: impl FnOnce(*mut dMass)) -> Mass {
    let mut mass = dMass::default();
    set(&mut mass);
    Mass::from_ode(&mass)
}

/// The corners of a box around the origin, numbered by the signs of x, y and z.
fn box_points(sides: [f64; 3]) -> Vec<Point3<f64>> {
    let sign = |i: u32, axis: usize| if i & (1 << axis) == 0 { -0.5 } else { 0.5 } * sides[axis];
    (0..8).map(|i| Point3::new(sign(i, 0), sign(i, 1), sign(i, 2))).collect()
}

const BOX_FACES: [[u32; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

#[test]
fn the_masses_of_simple_solids_agree_with_ode() {
    let density = Amount::Density(700.0);
    let sphere = Mass::of(&Shape::Sphere { radius: 0.3 }, density).unwrap();
    let cuboid = Mass::of(&Shape::cuboid(0.1, 0.2, 0.3), density).unwrap();
    let capsule = Mass::of(&Shape::Capsule { radius: 0.1, length: 0.5 }, density).unwrap();
    let cylinder = Mass::of(&Shape::Cylinder { radius: 0.1, length: 0.5 }, density).unwrap();

    // SAFETY: each function writes the structure it is given; direction 3 is z.
    unsafe {
        assert!(approx_eq(&sphere, &ode_mass(|mass| dMassSetSphere(mass, 700.0, 0.3))));
        assert!(approx_eq(&cuboid, &ode_mass(|mass| dMassSetBox(mass, 700.0, 0.1, 0.2, 0.3))));
        assert!(approx_eq(&capsule, &ode_mass(|mass| dMassSetCapsule(mass, 700.0, 3, 0.1, 0.5))));
        assert!(approx_eq(&cylinder, &ode_mass(|mass| dMassSetCylinder(mass, 700.0, 3, 0.1, 0.5))));
    }
}

#[test]
fn translation_rotation_scaling_and_addition_agree_with_ode() {
    let cuboid = Mass::of(&Shape::cuboid(0.1, 0.2, 0.3), Amount::Total(2.0)).unwrap();
    let rotation = UnitQuaternion::from_euler_angles(0.3, -0.4, 0.5);
    let ours = cuboid.translated(&Vector3::new(1.0, 2.0, 3.0)).unwrap().rotated(&rotation);
    let ours = ours.adjusted(5.0).unwrap().combined(&cuboid).unwrap();

    // SAFETY: each function reads and writes the structures it is given.
    let theirs = ode_mass(|mass| unsafe {
        let matrix: dMatrix3 = convert::ode_matrix(rotation.to_rotation_matrix().matrix());
        dMassSetBox(mass, 2.0 / 0.006, 0.1, 0.2, 0.3);
        let original = *mass;
        dMassTranslate(mass, 1.0, 2.0, 3.0);
        dMassRotate(mass, matrix.as_ptr());
        dMassAdjust(mass, 5.0);
        dMassAdd(mass, &original);
    });
    assert!(approx_eq(&ours, &theirs), "{ours:?}\n{theirs:?}");
}

#[test]
fn a_mesh_and_a_polyhedron_in_the_shape_of_a_box_have_its_mass() {
    let sides = [0.1, 0.2, 0.3];
    let cuboid = Mass::of(&Shape::cuboid(0.1, 0.2, 0.3), Amount::Density(1000.0)).unwrap();
    let faces: Vec<Vec<u32>> = BOX_FACES.iter().map(|face| face.to_vec()).collect();
    let convex = Shape::Convex(Arc::new(Convex::new(box_points(sides), &faces).unwrap()));
    assert!(approx_eq(&cuboid, &Mass::of(&convex, Amount::Density(1000.0)).unwrap()));

    let moved = box_points(sides).iter().map(|point| point + Vector3::new(1.0, 2.0, 3.0)).collect();
    let triangles = BOX_FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = Shape::TriMesh(Arc::new(TriMesh::new(moved, triangles).unwrap()));
    let mesh = Mass::of(&mesh, Amount::Density(1000.0)).unwrap();
    // The mesh is ten times its size away from the origin, so its inertia about its centre is a difference of large
    // numbers, and the tolerance is wider.
    assert!((mesh.center() - Point3::new(1.0, 2.0, 3.0)).norm() < 1e-10);
    assert!((mesh.centred().inertia() - cuboid.inertia()).norm() < 1e-8 * cuboid.inertia().norm());
}

#[test]
fn a_translation_or_rotation_and_its_inverse_restore_the_mass() {
    let mass = Mass::of(&Shape::cuboid(0.4, 0.5, 0.6), Amount::Total(3.0)).unwrap();
    let by = Vector3::new(0.1, -0.2, 0.3);
    assert!(approx_eq(&mass, &mass.translated(&by).unwrap().translated(&-by).unwrap()));
    assert!(approx_eq(&mass, &mass.translated(&by).unwrap().centred()));
    let rotation = UnitQuaternion::from_euler_angles(1.0, 2.0, 3.0);
    assert!(approx_eq(&mass, &mass.rotated(&rotation).rotated(&rotation.inverse())));
}

#[test]
fn amounts_and_shapes_without_mass_are_refused() {
    let sphere = Shape::Sphere { radius: 0.3 };
    for amount in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Mass::of(&sphere, Amount::Total(amount)).is_err(), "{amount}");
        assert!(Mass::of(&sphere, Amount::Density(amount)).is_err(), "{amount}");
        assert!(Mass::of(&sphere, Amount::Total(1.0)).unwrap().adjusted(amount).is_err(), "{amount}");
    }

    assert!(Mass::of(&Shape::Sphere { radius: 0.0 }, Amount::Total(1.0)).is_err());
    assert!(Mass::of(&Shape::Ray { length: 1.0 }, Amount::Total(1.0)).is_err());
    assert!(Mass::of(&Shape::Plane { normal: Vector3::z(), offset: 0.0 }, Amount::Total(1.0)).is_err());
    // The mass of a tiny solid underflows to 0.
    assert!(Mass::of(&Shape::Sphere { radius: 1e-120 }, Amount::Density(1.0)).is_err());

    let inside_out: Vec<[u32; 3]> =
        BOX_FACES.iter().flat_map(|&[a, b, c, d]| [[c, b, a], [d, c, a]]).collect();
    let mesh = Shape::TriMesh(Arc::new(TriMesh::new(box_points([1.0; 3]), inside_out).unwrap()));
    assert!(Mass::of(&mesh, Amount::Total(1.0)).is_err());
}

#[test]
fn an_inertia_that_no_solid_can_have_is_refused() {
    let new = |center: Point3<f64>, inertia: Matrix3<f64>| Mass::new(1.0, center, inertia);
    assert!(new(Point3::origin(), Matrix3::identity()).is_ok());
    assert!(new(Point3::origin(), Matrix3::zeros()).is_err());
    assert!(new(Point3::origin(), -Matrix3::identity()).is_err());
    assert!(new(Point3::origin(), Matrix3::identity() * f64::NAN).is_err());
    let mut skew = Matrix3::identity();
    skew[(0, 1)] = 0.5;
    assert!(new(Point3::origin(), skew).is_err());
    // About the origin, 1 kg at 2 m has an inertia of at least 4 kg m².
    assert!(new(Point3::new(2.0, 0.0, 0.0), Matrix3::identity()).is_err());
}

#[test]
fn a_body_takes_only_a_centred_mass() {
    let mass = Mass::of(&Shape::cuboid(1.0, 1.0, 1.0), Amount::Total(1.0)).unwrap();
    let off_centre = mass.translated(&Vector3::new(0.01, 0.0, 0.0)).unwrap();
    assert!(mass.to_ode().is_ok());
    assert!(off_centre.to_ode().unwrap_err().to_string().contains("centred"));
    assert_eq!(off_centre.centred().to_ode().unwrap().c, [0.0; 4]);
}
