//! What only a caller of ODE's own functions sees: strides, room, order, and geoms inside geom transforms.

use super::*;
use crate::hull::{Aabb, HullData};
use crate::ode::{Ode, Shape, World};
use crate::synthetic::{Placed, Solid, Subject, Texture, layout, silhouette};
use nalgebra::{point, vector};
use ode_sys::{
    dCollide, dCreateBox, dCreateGeomTransform, dGeomDestroy, dGeomSetPosition, dGeomTransformSetGeom,
};
use std::ptr::null_mut;
use std::sync::Arc;

/// A contact with memory behind it that must not be written.
#[repr(C)]
#[derive(Clone, Copy)]
struct Padded {
    contact: dContactGeom,
    guard: [u64; 5],
}

const GUARD: u64 = 0xfeed_beef_cafe_f00d;

fn fresh() -> [Padded; 6] {
    let contact = dContactGeom { depth: -7.0, ..dContactGeom::default() };
    [Padded { contact, guard: [GUARD; 5] }; 6]
}

/// A hull of a table 0.4 m wide with its top at 0.2 m, and the raw id of the geom.
fn table() -> (World, dGeomID) {
    let lengths = vector![0.4, 0.4, 0.4];
    let placed =
        Placed::new(Solid::cuboid(lengths).unwrap(), Isometry3::identity(), Texture::plain([200, 0, 0]));
    let subject = Subject::new(vec![placed]);
    let data = HullData::new();
    for camera in layout::face_on(lengths, &Isometry3::identity(), 2.8, 0.2, (320, 240), 0.4).unwrap() {
        let view = data.add_view(camera.clone()).unwrap();
        data.set_mask(view, &silhouette(&camera, &subject)).unwrap();
    }
    data.set_bounds(Aabb::new(point![-0.5, -0.5, -0.3], point![0.5, 0.5, 0.5]).unwrap()).unwrap();
    data.update(0.0).unwrap();
    let mut world = World::new(&Ode::init().unwrap()).unwrap();
    let root = world.root_space();
    let hull = world.add_hull(root, &Arc::new(data)).unwrap();
    world.collide(|_| ()).unwrap();
    // SAFETY: the world is returned beside it, and keeps the geom.
    let raw = unsafe { world.geom(hull).raw() };
    (world, raw)
}

/// A box of 0.1 m in no space, its base 4 mm deep in the table.
unsafe fn sunk_box() -> dGeomID {
    // SAFETY: the caller holds a world, so that ODE is open.
    unsafe {
        let sunk = dCreateBox(null_mut(), 0.1, 0.1, 0.1);
        dGeomSetPosition(sunk, 0.0, 0.0, 0.246);
        sunk
    }
}

#[test]
fn contacts_lie_skip_bytes_apart_and_nothing_else_is_written() {
    let (_world, hull) = table();
    let mut contacts = fresh();
    // SAFETY: living geoms, and room for six contacts of the size of `Padded`.
    let count = unsafe {
        let sunk = sunk_box();
        let count = dCollide(hull, sunk, 4, (&raw mut contacts).cast(), size_of::<Padded>() as c_int);
        dGeomDestroy(sunk);
        count
    };
    // A few: which samples wait for others on so coarse a hull is not the point here.
    assert!((2..=4).contains(&count));
    let (written, others) = contacts.split_at(count as usize);
    assert!(written.iter().all(|padded| padded.contact.depth >= 0.0 && padded.contact.normal[2] < -0.9));
    assert!(others.iter().all(|padded| padded.contact.depth == -7.0));
    assert!(contacts.iter().all(|padded| padded.guard == [GUARD; 5]));
}

#[test]
fn any_contacts_will_do_where_they_are_unimportant() {
    let (_world, hull) = table();
    let mut contacts = fresh();
    let flags = (CONTACTS_UNIMPORTANT | 2) as c_int;
    // SAFETY: as above.
    let count = unsafe {
        let sunk = sunk_box();
        let count = dCollide(sunk, hull, flags, (&raw mut contacts).cast(), size_of::<Padded>() as c_int);
        dGeomDestroy(sunk);
        count
    };
    assert_eq!(count, 2);
    assert!(contacts[2..].iter().all(|padded| padded.contact.depth == -7.0));
}

#[test]
fn a_body_inside_a_geom_transform_collides_where_the_transform_puts_it() {
    let (_world, hull) = table();
    let mut contacts = fresh();
    // SAFETY: as above; the transform owns nothing, and both are destroyed here.
    let count = unsafe {
        let inner = dCreateBox(null_mut(), 0.1, 0.1, 0.1);
        dGeomSetPosition(inner, 0.0, 0.0, 0.1);
        let outer = dCreateGeomTransform(null_mut());
        dGeomTransformSetGeom(outer, inner);
        dGeomSetPosition(outer, 0.0, 0.0, 0.146);
        let count = dCollide(hull, outer, 6, (&raw mut contacts).cast(), size_of::<Padded>() as c_int);
        dGeomDestroy(outer);
        dGeomDestroy(inner);
        count
    };
    assert!(count > 0);
    assert!(contacts[..count as usize].iter().all(|padded| (padded.contact.pos[2] - 0.196).abs() < 0.01));
}

#[test]
fn nothing_is_written_where_nothing_touches() {
    let (mut world, hull) = table();
    let root = world.root_space();
    let far = world.add_geom(root, &Shape::Sphere { radius: 0.1 }).unwrap();
    world.geom_mut(far).set_pose(&Isometry3::translation(0.0, 0.0, 0.31)).unwrap();
    // SAFETY: the geom stays as long as the world.
    let far = unsafe { world.geom(far).raw() };
    let mut contacts = fresh();
    // SAFETY: as above.
    let count = unsafe { dCollide(hull, far, 6, (&raw mut contacts).cast(), size_of::<Padded>() as c_int) };
    assert_eq!(count, 0);
    assert!(contacts.iter().all(|padded| padded.contact.depth == -7.0));
}
