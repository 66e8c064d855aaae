//! How the cost grows with cameras, resolution, samples, bodies and depth: a plot of each.

use crate::figure::Bound;
use crate::frames::{from_frame, from_masks};
use crate::plot::{Line, Plot};
use crate::points;
use crate::survey::{Start, Survey};
use crate::timing::{Race, Times};
use ode_visual_hull_bench::ours::Rig;
use ode_visual_hull_bench::scene::{
    Bodies, Given, Optics, SAMPLES_400, SAMPLES_4000, SIZES, Scene, VGA, Who,
};

pub fn measure(survey: &mut Survey) {
    cameras(survey);
    resolution(survey);
    samples(survey);
    bodies(survey);
    depth(survey);
}

/// The person before pinhole cameras.
fn pinholes(cameras: usize, size: (u32, u32)) -> Given {
    Given::new(Who::Person, cameras, size, Optics::Pinholes)
}

fn cameras(survey: &mut Survey) {
    let counts = [4, 7, 14, 28];
    let scenes = counts.map(|count| (count.to_string(), pinholes(count, VGA)));
    let bodies = Bodies::scattered(60, SAMPLES_400);
    let race = Race::new();
    let race = scenes.iter().fold(race, |race, (label, given)| from_masks(race, label, given, &bodies));
    let times = survey.race(race);

    let what = "masks in, default contacts out, 60 boxes of 400 samples";
    let ratio = times.ratio("ours 14", "ours 4");
    survey.asked("cameras_14_over_4", ratio, Bound::AtMost(3.2), Start::Masks, what);
    let sizes = counts.map(|count| (count as f64, count.to_string())).to_vec();
    draw(survey, "cameras", "cameras", FRAME, sizes, &times, &CONTENDERS);
}

fn resolution(survey: &mut Survey) {
    let scenes = SIZES.map(|(_, size)| pinholes(7, size));
    let bodies = Bodies::scattered(60, SAMPLES_400);
    let mut race = Race::new();
    for (given, (name, _)) in scenes.iter().zip(SIZES) {
        let rig = Rig::new(&given.ours);
        race = from_frame(race, name, given, &bodies)
            .with(format!("prepare {name}"), move || rig.publish(&given.ours.masks));
    }
    let times = survey.race(race);

    let what = "default contacts, 60 boxes of 400 samples";
    let ratio = times.ratio("ours 4K", "ours VGA");
    survey.asked("query_4k_over_vga", ratio, Bound::AtMost(1.9), Start::Frame, what);
    let what = "the literal program's body vectors, 60 boxes of 400 samples";
    let ratio = times.ratio("literal 4K", "literal VGA");
    survey.reported("query_4k_over_vga_literal", ratio, Start::Frame, what);
    let sizes = SIZES.map(|(name, (width, height))| (f64::from(width * height) * 1e-6, name.to_owned()));
    let lines = [CONTENDERS[0], CONTENDERS[1], ("prepare", "preparing the frame")];
    draw(survey, "resolution", "pixels of a mask", TIME, sizes.to_vec(), &times, &lines);
}

fn samples(survey: &mut Survey) {
    let given = pinholes(7, VGA);
    let features = [SAMPLES_400, 0.0213, 0.0136, SAMPLES_4000];
    let bodies = features.map(|feature| Bodies::scattered(60, feature));
    let label = |bodies: &Bodies| bodies.samples.points().len().to_string();
    let race = Race::new();
    let race = bodies.iter().fold(race, |race, bodies| from_frame(race, &label(bodies), &given, bodies));
    let times = survey.race(race);

    let [few, .., many] = &bodies;
    let ratio = times.ratio(&format!("ours {}", label(many)), &format!("ours {}", label(few)));
    let what = "default contacts, 60 boxes";
    survey.asked("samples_4000_over_400", ratio, Bound::AtMost(7.0), Start::Frame, what);
    let sizes = bodies.iter().map(|bodies| (bodies.samples.points().len() as f64, label(bodies)));
    draw(survey, "samples", "samples of a box", QUERY, sizes.collect(), &times, &CONTENDERS);
}

fn bodies(survey: &mut Survey) {
    let given = pinholes(7, VGA);
    let counts = [60, 600, 6000];
    let bodies = counts.map(|count| Bodies::scattered(count, SAMPLES_400));
    let label = |bodies: &Bodies| bodies.poses.len().to_string();
    let race = Race::new();
    let race = bodies.iter().fold(race, |race, bodies| from_masks(race, &label(bodies), &given, bodies));
    let times = survey.race(race);
    let sizes = bodies.iter().map(|bodies| (bodies.poses.len() as f64, label(bodies)));
    draw(survey, "bodies", "boxes of 400 samples", FRAME, sizes.collect(), &times, &CONTENDERS);
}

fn depth(survey: &mut Survey) {
    let scene = Scene::new(Who::Barrel, 7, VGA);
    let frame = Rig::new(&scene).publish(&scene.masks);
    let depths = [1, 2, 4, 8, 16, 32, 56];
    let mut race = Race::new();
    for depth in depths {
        let points = points::at_depth(&frame, depth..=depth, POINTS);
        race = points::respond(race, &depth.to_string(), &scene, &frame, &points);
    }
    let times = survey.race(race);
    let sizes = depths.map(|depth| (f64::from(depth), depth.to_string())).to_vec();
    draw(survey, "depth", "pixels to the nearest background", RESPONSE, sizes, &times, &RESPONDERS);
}

/// What is on the y axis, and its unit in seconds.
type Cost = (&'static str, f64);

const FRAME: Cost = ("from masks on (ms)", 1e-3);
const TIME: Cost = ("time (ms)", 1e-3);
const QUERY: Cost = ("in a prepared frame (ms)", 1e-3);
/// Of one point among [`POINTS`].
const RESPONSE: Cost = ("response of a point (ns)", 1e-9 * POINTS as f64);
const POINTS: usize = 1_000;

/// How contenders' names begin, and what the plots call them.
const CONTENDERS: [(&str, &str); 2] =
    [("literal", "the paper's body vectors, literally"), ("ours", "this library's contacts")];

/// How the plot of responses calls them.
const RESPONDERS: [(&str, &str); 2] =
    [("literal", "the paper's algorithm, literally"), ("ours", "this library")];

/// Draws the contenders' times over the sizes, which are labelled as the contenders' names end.
fn draw(
    survey: &Survey,
    name: &str,
    x: &str,
    (y, unit): Cost,
    sizes: Vec<(f64, String)>,
    times: &Times,
    contenders: &[(&str, &str)],
) {
    let line = |(prefix, name): &(&str, &str)| Line {
        name: (*name).to_owned(),
        points: sizes
            .iter()
            .map(|(x, label)| (*x, times.seconds(&format!("{prefix} {label}")) / unit))
            .collect(),
    };
    let lines = contenders.iter().map(line).collect();
    let folder = survey.docs().join("performance");
    let path = folder.join(format!("{name}.svg"));
    let written = std::fs::create_dir_all(&folder).map_err(Into::into);
    let written = written.and_then(|()| Plot { x, y, ticks: sizes, lines }.write(&path));
    written.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}
