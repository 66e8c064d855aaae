//! The alternatives to the library: carve voxels, mesh them, build an engine's tree over the mesh, and collide with
//! that.

use crate::frames::with_body_vectors;
use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use ode_visual_hull_bench::carve::Grid;
use ode_visual_hull_bench::nets::Mesh;
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, Inputs, Optics, SAMPLES_400, Scene, SubjectKind, VGA};
use ode_visual_hull_bench::{ode, parry};
use ode_visual_hull_testing::figure::Bound;

const PEERS: [&str; 3] = ["ode_trimesh", "parry_trimesh", "parry_voxels"];

/// For each benchmark: the suffix of the figures' names, the cameras' optics, the edge of a voxel in metres, and the
/// bound on each peer's time divided by the time of the library's default contacts.
const BENCHES: [(&str, Optics, f64, [Option<f64>; 3]); 3] = [
    ("1cm", Optics::Pinholes, 0.01, [Some(70.0), None, Some(21.0)]),
    ("2cm", Optics::Pinholes, 0.02, [None; 3]),
    ("1cm_lens", Optics::Lenses, 0.01, [Some(50.0), None, Some(15.0)]),
];

pub fn run_group(session: &mut Session) {
    let bodies = Bodies::scattered(60, SAMPLES_400);
    for (name, optics, cell, bounds) in BENCHES {
        let input = Inputs::new(SubjectKind::Person, 7, VGA, optics);
        let times = session.run(bench(&input, &bodies, cell));

        let what = "masks in, contacts of 60 boxes out, over the library's default contacts";
        for (peer, bound) in PEERS.into_iter().zip(bounds) {
            let ratio = times.ratio(peer, "contacts");
            let bound = bound.map(Bound::AtLeast);
            session.figure(&format!("contacts_over_{peer}_{name}"), ratio, bound, StartTime::Masks, what);
        }

        let what = "masks in, contacts of 60 boxes out, over the library's body vectors";
        for peer in PEERS {
            let ratio = times.ratio(peer, "response");
            session.reported(&format!("body_response_over_{peer}_{name}"), ratio, StartTime::Masks, what);
        }

        let what =
            "the part of the routes over voxels that all share: preparing, and carving by our inside test";
        session.reported(&format!("carve_{name}_ms"), 1e3 * times.seconds("carve"), StartTime::Masks, what);
    }
}

fn bench<'a>(input: &'a Inputs, bodies: &'a Bodies, cell: f64) -> PairedBench<'a> {
    let bench = with_ours(PairedBench::new(), &input.ours, bodies);
    let peer = || VoxelPeer::new(&input.peers, cell);
    let mut carving = peer();
    let bench = bench.with("carve", move || carving.carve());

    let (mut meshing, mut boxes) = (peer(), ode::mesh::Boxes::new(bodies).expect("ODE opens"));
    let bench = bench.with("ode_trimesh", move || {
        meshing.mesh();
        boxes.with_mesh(&meshing.mesh, &mut meshing.counts);
        meshing.counts.len()
    });

    let (mut meshing, mut boxes) = (peer(), parry::Boxes::new(bodies));
    let bench = bench.with("parry_trimesh", move || {
        meshing.mesh();
        boxes.with_mesh(&meshing.mesh, &mut meshing.counts);
        meshing.counts.len()
    });

    let (mut carving, mut boxes) = (peer(), parry::Boxes::new(bodies));
    bench.with("parry_voxels", move || {
        carving.carve();
        boxes.with_voxels(&carving.grid, &mut carving.counts);
        carving.counts.len()
    })
}

fn with_ours<'a>(bench: PairedBench<'a>, scene: &'a Scene, bodies: &'a Bodies) -> PairedBench<'a> {
    let (rig, boxes, mut contacts) = (Rig::new(scene), Boxes::new(bodies), Vec::new());
    let bench = bench.with("contacts", move || {
        rig.publish(&scene.masks).contacts(&boxes, &mut contacts);
        contacts.len()
    });
    with_body_vectors(bench, "response", scene, bodies)
}

/// The steps that all candidates with voxels share. Each candidate has buffers of its own, used again in each frame.
struct VoxelPeer<'a> {
    scene: &'a Scene,
    rig: Rig,
    grid: Grid,
    mesh: Mesh,
    /// Number of contacts of each box.
    counts: Vec<usize>,
}

impl<'a> VoxelPeer<'a> {
    fn new(scene: &'a Scene, cell: f64) -> Self {
        let (rig, grid) = (Rig::new(scene), Grid::new(cell));
        Self { scene, rig, grid, mesh: Mesh::default(), counts: Vec::new() }
    }

    /// Prepares the frame and carves its voxels.
    fn carve(&mut self) {
        self.grid.carve(&self.rig.publish(&self.scene.masks));
    }

    /// Prepares the frame, carves its voxels and meshes them.
    fn mesh(&mut self) {
        self.carve();
        self.mesh.build(&self.grid);
    }
}
