//! What one would do instead: carve voxels, mesh them, build the engine's tree over the mesh, and collide with that.

use crate::figure::Bound;
use crate::survey::{Start, Survey};
use crate::timing::Race;
use ode_visual_hull::hull::Workspace;
use ode_visual_hull_bench::carve::Grid;
use ode_visual_hull_bench::nets::Mesh;
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, SAMPLES_400, Scene, VGA, Who};
use ode_visual_hull_bench::{ode, parry};

const PEERS: [&str; 3] = ["ode_trimesh", "parry_trimesh", "parry_voxels"];

/// Edges of a voxel in metres, and what is asked of each peer's time over that of the paper's body vectors.
const CELLS: [(&str, f64, [Option<f64>; 3]); 2] =
    [("1cm", 0.01, [Some(120.0), Some(100.0), Some(30.0)]), ("2cm", 0.02, [Some(25.0), None, Some(6.0)])];

pub fn measure(survey: &mut Survey) {
    let scene = Scene::new(Who::Person, 7, VGA);
    let bodies = Bodies::scattered(60, SAMPLES_400);
    for (name, cell, bounds) in CELLS {
        let times = survey.race(race(&scene, &bodies, cell));
        let what = "masks in, contacts of 60 boxes out, over the library's body vectors";
        for (peer, bound) in PEERS.into_iter().zip(bounds) {
            let ratio = times.ratio(peer, "vectors");
            let figure = format!("frame_over_{peer}_{name}");
            match bound {
                Some(bound) => survey.asked(&figure, ratio, Bound::AtLeast(bound), Start::Masks, what),
                None => survey.reported(&figure, ratio, Start::Masks, what),
            }
        }
        let what = "the same over the library's default contacts";
        for peer in PEERS {
            let ratio = times.ratio(peer, "contacts");
            survey.reported(&format!("contacts_over_{peer}_{name}"), ratio, Start::Masks, what);
        }
        let what =
            "the part of the routes over voxels that all share: preparing, and carving by our inside test";
        survey.reported(&format!("carve_{name}_ms"), 1e3 * times.seconds("carve"), Start::Masks, what);
    }
}

fn race<'a>(scene: &'a Scene, bodies: &'a Bodies, cell: f64) -> Race<'a> {
    let race = with_ours(Race::new(), scene, bodies);
    let mut route = Route::new(scene, cell);
    let race = race.with("carve", move || route.carve());
    let mut route = Route::new(scene, cell);
    let mut boxes = ode::mesh::Boxes::new(bodies).expect("ODE opens");
    let race = race.with("ode_trimesh", move || {
        route.mesh();
        boxes.with_mesh(&route.mesh, &mut route.counts);
        route.counts.len()
    });
    let (mut route, mut boxes) = (Route::new(scene, cell), parry::Boxes::new(bodies));
    let race = race.with("parry_trimesh", move || {
        route.mesh();
        boxes.with_mesh(&route.mesh, &mut route.counts);
        route.counts.len()
    });
    let (mut route, mut boxes) = (Route::new(scene, cell), parry::Boxes::new(bodies));
    race.with("parry_voxels", move || {
        route.carve();
        boxes.with_voxels(&route.grid, &mut route.counts);
        route.counts.len()
    })
}

fn with_ours<'a>(race: Race<'a>, scene: &'a Scene, bodies: &'a Bodies) -> Race<'a> {
    let (rig, boxes, mut contacts) = (Rig::new(scene), Boxes::new(bodies), Vec::new());
    let race = race.with("contacts", move || {
        rig.publish(&scene.masks).contacts(&boxes, &mut contacts);
        contacts.len()
    });
    let (rig, boxes, mut vectors) = (Rig::new(scene), Boxes::new(bodies), Vec::new());
    let mut workspace = Workspace::new();
    race.with("vectors", move || {
        rig.publish(&scene.masks).body_vectors(&boxes, &mut vectors, &mut workspace);
        vectors.len()
    })
}

/// What the routes over voxels have in common. Each has memory of its own, used again from frame to frame.
struct Route<'a> {
    scene: &'a Scene,
    rig: Rig,
    grid: Grid,
    mesh: Mesh,
    /// How many contacts each box has.
    counts: Vec<usize>,
}

impl<'a> Route<'a> {
    fn new(scene: &'a Scene, cell: f64) -> Self {
        let (rig, grid) = (Rig::new(scene), Grid::new(cell));
        Self { scene, rig, grid, mesh: Mesh::default(), counts: Vec::new() }
    }

    /// Masks in, voxels out.
    fn carve(&mut self) {
        self.grid.carve(&self.rig.publish(&self.scene.masks));
    }

    /// Masks in, triangles out.
    fn mesh(&mut self) {
        self.carve();
        self.mesh.build(&self.grid);
    }
}
