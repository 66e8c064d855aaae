//! How the cost grows with cameras, resolution, samples, bodies and depth, with a plot of each.

use crate::frames::{from_frame, from_masks};
use crate::plot::{Line, Plot};
use crate::points;
use crate::session::{Session, StartTime};
use crate::timing::{PairedBench, Times};
use ode_visual_hull_bench::ours::Rig;
use ode_visual_hull_bench::scene::{
    Bodies, Inputs, Optics, SAMPLES_400, SAMPLES_4000, SIZES, Scene, SubjectKind, VGA,
};
use ode_visual_hull_testing::figure::Bound;

pub fn run_group(session: &mut Session) {
    cameras(session);
    resolution(session);
    samples(session);
    bodies(session);
    depth(session);
}

/// The person seen by pinhole cameras.
fn pinholes(cameras: usize, size: (u32, u32)) -> Inputs {
    Inputs::new(SubjectKind::Person, cameras, size, Optics::Pinholes)
}

fn cameras(session: &mut Session) {
    let counts = [4, 7, 14, 28];
    let scenes = counts.map(|count| (count.to_string(), pinholes(count, VGA)));
    let bodies = Bodies::scattered(60, SAMPLES_400);
    let bench = PairedBench::new();
    let bench = scenes.iter().fold(bench, |bench, (label, input)| from_masks(bench, label, input, &bodies));
    let times = session.run(bench);

    let what = "masks in, default contacts out, 60 boxes of 400 samples";
    let ratio = times.ratio("ours 14", "ours 4");
    session.bounded("cameras_14_over_4", ratio, Bound::AtMost(3.2), StartTime::Masks, what);

    let sizes = counts.map(|count| (count as f64, count.to_string())).to_vec();
    draw(session, "cameras", "cameras", FRAME, sizes, &times, &CANDIDATES);
}

fn resolution(session: &mut Session) {
    let scenes = SIZES.map(|(_, size)| pinholes(7, size));
    let bodies = Bodies::scattered(60, SAMPLES_400);
    let mut bench = PairedBench::new();
    for (input, (name, _)) in scenes.iter().zip(SIZES) {
        let rig = Rig::new(&input.ours);
        bench = from_frame(bench, name, input, &bodies)
            .with(format!("prepare {name}"), move || rig.publish(&input.ours.masks));
    }

    let times = session.run(bench);

    let what = "default contacts, 60 boxes of 400 samples";
    let ratio = times.ratio("ours 4K", "ours VGA");
    session.bounded("query_4k_over_vga", ratio, Bound::AtMost(1.9), StartTime::Frame, what);
    let what = "the literal program's body vectors, 60 boxes of 400 samples";
    let ratio = times.ratio("literal 4K", "literal VGA");
    session.reported("query_4k_over_vga_literal", ratio, StartTime::Frame, what);

    let sizes = SIZES.map(|(name, (width, height))| (f64::from(width * height) * 1e-6, name.to_owned()));
    let lines = [CANDIDATES[0], CANDIDATES[1], ("prepare", "preparing the frame")];

    draw(session, "resolution", "pixels of a mask", TIME, sizes.to_vec(), &times, &lines);
}

fn samples(session: &mut Session) {
    let input = pinholes(7, VGA);
    let features = [SAMPLES_400, 0.0213, 0.0136, SAMPLES_4000];
    let bodies = features.map(|feature| Bodies::scattered(60, feature));
    let label = |bodies: &Bodies| bodies.samples.points().len().to_string();
    let bench = PairedBench::new();
    let bench = bodies.iter().fold(bench, |bench, bodies| from_frame(bench, &label(bodies), &input, bodies));
    let times = session.run(bench);

    let [few, .., many] = &bodies;
    let ratio = times.ratio(&format!("ours {}", label(many)), &format!("ours {}", label(few)));
    let what = "default contacts, 60 boxes";
    session.bounded("samples_4000_over_400", ratio, Bound::AtMost(7.0), StartTime::Frame, what);

    let sizes = bodies.iter().map(|bodies| (bodies.samples.points().len() as f64, label(bodies)));

    draw(session, "samples", "samples of a box", QUERY, sizes.collect(), &times, &CANDIDATES);
}

fn bodies(session: &mut Session) {
    let input = pinholes(7, VGA);
    let counts = [60, 600, 6000];
    let bodies = counts.map(|count| Bodies::scattered(count, SAMPLES_400));
    let label = |bodies: &Bodies| bodies.poses.len().to_string();
    let bench = PairedBench::new();
    let bench = bodies.iter().fold(bench, |bench, bodies| from_masks(bench, &label(bodies), &input, bodies));
    let times = session.run(bench);

    let sizes = bodies.iter().map(|bodies| (bodies.poses.len() as f64, label(bodies)));
    draw(session, "bodies", "boxes of 400 samples", FRAME, sizes.collect(), &times, &CANDIDATES);
}

fn depth(session: &mut Session) {
    let scene = Scene::new(SubjectKind::Barrel, 7, VGA);
    let frame = Rig::new(&scene).publish(&scene.masks);
    let depths = [1, 2, 4, 8, 16, 32, 56];
    let mut bench = PairedBench::new();
    for depth in depths {
        let points = points::at_depth(&frame, depth..=depth, POINTS);
        bench = points::respond(bench, &depth.to_string(), &scene, &frame, &points);
    }
    let times = session.run(bench);

    let sizes = depths.map(|depth| (f64::from(depth), depth.to_string())).to_vec();
    draw(session, "depth", "pixels to the nearest background", RESPONSE, sizes, &times, &RESPONDERS);
}

/// The label of the y axis, and its unit in seconds.
type Cost = (&'static str, f64);

const FRAME: Cost = ("from masks on (ms)", 1e-3);
const TIME: Cost = ("time (ms)", 1e-3);
const QUERY: Cost = ("in a prepared frame (ms)", 1e-3);
/// Cost of one point; a run of a candidate responds to [`POINTS`] of them.
const RESPONSE: Cost = ("response of a point (ns)", 1e-9 * POINTS as f64);
const POINTS: usize = 1_000;

/// The prefixes of the candidates' names, and their labels in the plots.
const CANDIDATES: [(&str, &str); 2] =
    [("literal", "the paper's body vectors, literally"), ("ours", "this library's contacts")];

/// The prefixes of the candidates' names, and their labels in the plot of responses.
const RESPONDERS: [(&str, &str); 2] =
    [("literal", "the paper's algorithm, literally"), ("ours", "this library")];

/// Draws the candidates' times over `sizes`, whose labels are the suffixes of the candidates' names.
fn draw(
    session: &Session,
    name: &str,
    x: &str,
    (y, unit): Cost,
    sizes: Vec<(f64, String)>,
    times: &Times,
    candidates: &[(&str, &str)],
) {
    let line = |(prefix, name): &(&str, &str)| Line {
        name: (*name).to_owned(),
        points: sizes
            .iter()
            .map(|(x, label)| (*x, times.seconds(&format!("{prefix} {label}")) / unit))
            .collect(),
    };
    let lines = candidates.iter().map(line).collect();

    let folder = session.docs().join("performance");
    let path = folder.join(format!("{name}.svg"));
    let written = std::fs::create_dir_all(&folder).map_err(Into::into);
    let written = written.and_then(|()| Plot { x, y, ticks: sizes, lines }.write(&path));

    written.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}
