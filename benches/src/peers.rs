//! What one would do instead: carve voxels, mesh them, build the engine's tree over the mesh, and collide with that.

use crate::figure::Bound;
use crate::session::{Session, Start};
use crate::timing::Race;
use ode_visual_hull::hull::Workspace;
use ode_visual_hull_bench::carve::Grid;
use ode_visual_hull_bench::nets::Mesh;
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, SAMPLES_400, Scene, VGA, Who};
use ode_visual_hull_bench::{ode_mesh, parry};

/// Edges of a voxel in metres, and what is asked of ODE's mesh, parry3d's mesh and parry3d's voxels over ours.
const CELLS: [(&str, f64, [Option<f64>; 3]); 2] =
    [("1cm", 0.01, [Some(120.0), Some(100.0), Some(30.0)]), ("2cm", 0.02, [Some(25.0), None, Some(6.0)])];

pub fn measure(session: &mut Session) {
    let scene = Scene::new(Who::Person, 7, VGA);
    let bodies = Bodies::scattered(60, SAMPLES_400);
    for (name, cell, bounds) in CELLS {
        let times = session.race(race(&scene, &bodies, cell));
        let what = "masks in, contacts of 60 boxes out, over the library's default contacts";
        for (peer, bound) in ["ode_trimesh", "parry_trimesh", "parry_voxels"].into_iter().zip(bounds) {
            let ratio = times.ratio(peer, "contacts");
            let figure = format!("frame_over_{peer}_{name}");
            match bound {
                Some(bound) => session.asked(&figure, ratio, Bound::AtLeast(bound), Start::Masks, what),
                None => session.reported(&figure, ratio, Start::Masks, what),
            }
        }
        let what = "the same over the paper's body vectors";
        for peer in ["ode_trimesh", "parry_trimesh", "parry_voxels"] {
            let ratio = times.ratio(peer, "vectors");
            session.reported(&format!("vectors_over_{peer}_{name}"), ratio, Start::Masks, what);
        }
        let what =
            "the part of the routes over voxels that all share: preparing, and carving by our inside test";
        session.reported(&format!("carve_{name}_ms"), 1e3 * times.seconds("carve"), Start::Masks, what);
    }
}

fn race<'a>(scene: &'a Scene, bodies: &'a Bodies, cell: f64) -> Race<'a> {
    let rig = Rig::new(scene);
    let carved = {
        let rig = Rig::new(scene);
        move |grid: &mut Grid| grid.carve(&rig.publish(&scene.masks))
    };
    // Each route has memory of its own, used again from frame to frame.
    let carved = std::rc::Rc::new(carved);
    let route = || (carved.clone(), Grid::new(cell), Mesh::default(), Vec::new());
    let mut ode = ode_mesh::Boxes::new(bodies).expect("ODE opens");
    let (mut for_mesh, mut for_voxels) = (parry::Boxes::new(bodies), parry::Boxes::new(bodies));
    let (mut counts, mut vectors) = (Vec::new(), Vec::new());
    let rig = std::rc::Rc::new(rig);
    let same_rig = rig.clone();
    let boxes = std::rc::Rc::new(Boxes::new(bodies));
    let (same_boxes, mut workspace) = (boxes.clone(), Workspace::new());
    let race = Race::new()
        .with("contacts", move || {
            rig.publish(&scene.masks).contacts(&boxes, &mut counts);
            counts.len()
        })
        .with("vectors", move || {
            same_rig.publish(&scene.masks).body_vectors(&same_boxes, &mut vectors, &mut workspace);
            vectors.len()
        });
    let (carve, mut grid, ..) = route();
    let race = race.with("carve", move || carve(&mut grid));
    let (carve, mut grid, mut mesh, mut counts) = route();
    let race = race.with("ode_trimesh", move || {
        carve(&mut grid);
        mesh.build(&grid);
        ode.with_mesh(&mesh, &mut counts);
        counts.len()
    });
    let (carve, mut grid, mut mesh, mut counts) = route();
    let race = race.with("parry_trimesh", move || {
        carve(&mut grid);
        mesh.build(&grid);
        for_mesh.with_mesh(&mesh, &mut counts);
        counts.len()
    });
    let (carve, mut grid, _, mut counts) = route();
    race.with("parry_voxels", move || {
        carve(&mut grid);
        for_voxels.with_voxels(&grid, &mut counts);
        counts.len()
    })
}
