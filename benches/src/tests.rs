//! Tests that the comparisons are fair: all candidates compute the same thing.

use crate::carve::Grid;
use crate::literal::{LiteralBodies, LiteralHull, Vec3};
use crate::nets::Mesh;
use crate::ours::{Boxes, Frame, Rig};
use crate::scene::{Bodies, Inputs, Optics, SAMPLES_400, SAMPLES_4000, Scene, SubjectKind, VGA};
use crate::{ode, parry};
use nalgebra::{Point3, Vector3};
use ode_visual_hull::contact::BodyContacts;
use ode_visual_hull::hull::reference;
use ode_visual_hull_testing::random::Random;

fn plain(p: &Point3<f64>) -> Vec3 {
    p.coords.cast::<f32>().into()
}

fn person() -> (Scene, Frame) {
    let scene = Scene::new(SubjectKind::Person, 7, VGA);
    let frame = Rig::new(&scene).publish(&scene.masks);
    (scene, frame)
}

/// Metres between two vectors, one of them in `f32`.
fn distance(a: &Vec3, b: &Vector3<f64>) -> f64 {
    (Vector3::from(*a).cast::<f64>() - b).norm()
}

#[test]
fn boxes_have_400_or_4000_samples_and_a_quarter_touches_the_person() {
    let (_, frame) = person();
    assert_eq!(Bodies::scattered(1, SAMPLES_400).samples.points().len(), 400);

    let many = Bodies::scattered(1, SAMPLES_4000).samples.points().len();
    assert!((3900..=4100).contains(&many), "{many}");

    for count in [60, 600] {
        let mut vectors = Vec::new();
        let bodies = Bodies::scattered(count, SAMPLES_400);
        frame.body_vectors(&Boxes::new(&bodies), &mut vectors);
        let touching = vectors.iter().filter(|vector| vector.colliding > 0).count();
        let samples: usize = vectors.iter().map(|vector| vector.colliding).sum();
        assert!((count / 5..=count * 3 / 10).contains(&touching), "{touching} of {count}");
        assert!((15 * count..=20 * count).contains(&samples), "{samples} samples of {count} boxes");
    }
}

/// Rounding to `f32` moves a projection by up to 0.0002 pixels, so that about one in a thousand points within a pixel
/// of an edge falls on its other side.
#[test]
fn the_literal_program_and_the_reference_agree_on_what_is_inside() {
    let (scene, frame) = person();
    let literal = LiteralHull::new(&scene, frame.aabb());
    let mut random = Random(5);
    let points: Vec<_> = (0..20_000).map(|_| random.point(frame.aabb().min, frame.aabb().max)).collect();
    let inside = points.iter().filter(|p| reference::inside(frame.hull(), p)).count();
    let differ = points.iter().filter(|p| literal.inside(&plain(p)) != reference::inside(frame.hull(), p));
    assert!(inside > 500, "{inside} points inside");
    assert!(differ.clone().count() <= 2, "{} of 20000 points differ", differ.count());
}

/// Where two views are equally near, or the point lies on a pixel's border, rounding may choose another edge.
#[test]
fn the_literal_program_and_the_reference_give_the_same_responses() {
    for kind in [SubjectKind::Person, SubjectKind::Barrel] {
        let scene = Scene::new(kind, 7, VGA);
        let frame = Rig::new(&scene).publish(&scene.masks);
        let literal = LiteralHull::new(&scene, frame.aabb());
        let mut random = Random(7);

        let points = std::iter::repeat_with(|| random.point(frame.aabb().min, frame.aabb().max));
        let points = points.filter(|p| reference::inside(frame.hull(), p)).take(1_000);

        let (mut all, mut agree) = (0, 0);
        for p in points {
            let expected = reference::respond(frame.hull(), &p).expect("a point inside");
            let quarter_pixel = 0.25 * frame.hull().pixel_size(&p);
            let same = literal.respond(&plain(&p)).is_some_and(|found| {
                found.view == expected.view
                    && distance(&found.w(), &(expected.normal * expected.depth)) <= quarter_pixel
            });
            all += 1;
            agree += usize::from(same);
        }
        assert!(agree as f64 >= 0.999 * f64::from(all), "{kind:?}: {agree} of {all} agree");
    }
}

/// A body's vector is as long as its longest exit, which changes where rounding misses an edge. So most bodies, but not
/// all, agree to a quarter of a pixel. Where the responses nearly cancel, the direction is not determined.
#[test]
fn the_literal_program_and_the_library_give_the_same_body_vectors() {
    let (scene, frame) = person();
    let bodies = Bodies::scattered(600, SAMPLES_400);
    let (mut expected, mut found) = (Vec::new(), Vec::new());
    frame.body_vectors(&Boxes::new(&bodies), &mut expected);
    LiteralBodies::new(&bodies).vectors(&LiteralHull::new(&scene, frame.aabb()), &mut found);

    let touching = expected.iter().filter(|expected| expected.colliding > 0).count();
    let pairs = expected.iter().zip(&found).filter(|(expected, _)| expected.colliding > 0);
    let same = pairs.filter(|(expected, found)| {
        expected.colliding.abs_diff(found.colliding) <= 1
            && distance(&found.vector, &expected.vector) <= 0.0015
    });
    let same = same.count();
    assert!(same as f64 >= 0.98 * touching as f64, "{same} of {touching} bodies agree");
}

/// Where the cameras have lenses, the peers get undistorted masks, and the library starts from the distorted ones. Both
/// find the same bodies in contact, except some that penetrate by less than a pixel, which covers 6 mm. The literal
/// program tests whole pixels in `f32`, while the library interpolates the edge within a pixel where undistorting
/// leaves bytes between 0 and 255.
#[test]
fn the_literal_program_and_the_library_find_the_same_bodies_in_contact_also_behind_lenses() {
    let bodies = Bodies::scattered(600, SAMPLES_400);
    for optics in [Optics::Pinholes, Optics::Lenses] {
        let inputs = Inputs::new(SubjectKind::Person, 7, VGA, optics);
        let has_lens = |scene: &Scene| scene.cameras.iter().any(|camera| !camera.lens().is_none());
        assert_eq!((has_lens(&inputs.ours), has_lens(&inputs.peers)), (optics == Optics::Lenses, false));

        let frame = Rig::new(&inputs.ours).publish(&inputs.ours.masks);
        let (mut contacts, mut vectors) = (Vec::new(), Vec::new());
        frame.contacts(&Boxes::new(&bodies), &mut contacts);
        LiteralBodies::new(&bodies).vectors(&LiteralHull::new(&inputs.peers, frame.aabb()), &mut vectors);

        let touching = contacts.iter().filter(|contacts| !contacts.points.is_empty()).count();
        assert!((120..=180).contains(&touching), "{optics:?}: {touching} of 600 bodies touch");
        let pairs = contacts.iter().zip(&vectors);
        let differ = pairs.filter(|(ours, literal)| ours.points.is_empty() != (literal.colliding == 0));
        let deepest = |ours: &BodyContacts| ours.points.iter().map(|point| point.depth).fold(0.0, f64::max);
        let depths: Vec<_> = differ
            .map(|(ours, literal)| deepest(ours).max(distance(&literal.vector, &Vector3::zeros())))
            .collect();
        assert!(depths.len() <= 6, "{optics:?}: only one finds a contact {depths:?} m deep");
        assert!(depths.iter().all(|depth| *depth < 0.006), "{optics:?}: {depths:?} m deep");
    }
}

/// The comparisons of the library with itself are fair too: nearly the same bodies touch the person with each kind of
/// mask and camera. The others penetrate by less than a pixel or two, as noise moves an outline.
#[test]
fn lenses_abstaining_views_and_coverage_find_nearly_the_same_bodies_in_contact() {
    let boxes = Boxes::new(&Bodies::scattered(600, SAMPLES_400));
    let touching = |rig: Rig, scene: &Scene| -> Vec<bool> {
        let mut contacts = Vec::new();
        rig.publish(&scene.masks).contacts(&boxes, &mut contacts);
        contacts.iter().map(|contacts| !contacts.points.is_empty()).collect()
    };
    let differ = |a: &[bool], b: &[bool]| a.iter().zip(b).filter(|(a, b)| a != b).count();

    let scene = Scene::new(SubjectKind::Person, 7, VGA);
    let lens = Scene::through_lenses(SubjectKind::Person, 7, VGA);
    let segmented = Scene::segmented(SubjectKind::Person, 7, VGA);
    let expected = touching(Rig::new(&scene), &scene);
    let count = expected.iter().filter(|touches| **touches).count();

    for (name, found) in [
        ("lenses", touching(Rig::new(&lens), &lens)),
        ("views that abstain", touching(Rig::abstaining(&scene), &scene)),
        ("coverage", touching(Rig::new(&segmented), &segmented)),
        ("coverage made binary", touching(Rig::new(&segmented.binary()), &segmented.binary())),
    ] {
        let differ = differ(&expected, &found);
        assert!(differ * 20 <= count, "{name}: {differ} bodies differ, of {count} that touch");
    }
}

/// The peers with voxels find nearly the same boxes in contact. Of some 150 boxes, the meshes miss at most 3 and find
/// at most 2 more; the voxels, which stick out by up to half a voxel, find at most 10 more. The sets differ only where
/// a box penetrates by less than a voxel: a voxel is inside or outside by its centre, and only the peers test a box's
/// faces between its samples. (A box entirely within the hull would have no contact with a triangle mesh, which is
/// hollow, but none of these boxes is so small.)
#[test]
fn each_peer_finds_contacts_for_the_bodies_that_the_library_finds_in_contact() {
    let (_, frame) = person();
    let bodies = Bodies::scattered(600, SAMPLES_400);
    let mut contacts = Vec::new();
    frame.contacts(&Boxes::new(&bodies), &mut contacts);
    let ours: Vec<_> = contacts.iter().map(|contacts| contacts.points.len()).collect();
    let mut vectors = Vec::new();
    frame.body_vectors(&Boxes::new(&bodies), &mut vectors);

    for cell in [0.01, 0.02] {
        let mut grid = Grid::new(cell);
        grid.carve(&frame);
        let mut mesh = Mesh::default();
        mesh.build(&grid);

        let mut counts = [Vec::new(), Vec::new(), Vec::new()];
        ode::mesh::Boxes::new(&bodies).unwrap().with_mesh(&mesh, &mut counts[0]);
        parry::Boxes::new(&bodies).with_mesh(&mesh, &mut counts[1]);
        parry::Boxes::new(&bodies).with_voxels(&grid, &mut counts[2]);
        for (peer, counts) in ["ODE's mesh", "parry3d's mesh", "parry3d's voxels"].iter().zip(&counts) {
            let depth = |k: usize| vectors[k].vector.norm();
            let missed: Vec<_> = (0..600).filter(|&k| ours[k] > 0 && counts[k] == 0).map(depth).collect();
            assert!(missed.iter().all(|depth| *depth < cell), "{peer}, {cell} m misses {missed:?}");
            let more = (0..600).filter(|&k| ours[k] == 0 && counts[k] > 0).count();
            assert!(more <= 12, "{peer}, {cell} m finds {more} more");
        }
    }
}

#[test]
fn the_mesh_of_the_voxels_is_closed_and_faces_outwards() {
    let (_, frame) = person();
    let mut grid = Grid::new(0.02);
    grid.carve(&frame);

    let mut mesh = Mesh::default();
    mesh.build(&grid);

    let corner = |k: u32| Vector3::from(mesh.points[k as usize]).cast::<f64>();
    let six_volumes = mesh.triangles.iter().map(|t| corner(t[0]).dot(&corner(t[1]).cross(&corner(t[2]))));
    let volume = six_volumes.sum::<f64>() / 6.0;
    let carved = grid.cells_inside().count() as f64 * grid.cell.powi(3);
    // Naive surface nets cut off corners, by a part of a voxel on a surface of about 3 square metres.
    assert!((volume / carved - 1.0).abs() < 0.1, "mesh {volume} m3, voxels {carved} m3");
}
