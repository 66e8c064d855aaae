//! Queries of points: the inside test and the response.

use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::hull::{Points, Workspace};
use ode_visual_hull_bench::literal::{LiteralHull, Vec3};
use ode_visual_hull_bench::ours::{Frame, Rig};
use ode_visual_hull_bench::scene::{Bodies, SAMPLES_400, Scene, SubjectKind, VGA};
use ode_visual_hull_testing::figure::Bound;
use ode_visual_hull_testing::random::Random;

/// Number of points of an inside test.
const INSIDE_POINTS: usize = 24_000;

/// Number of points whose responses are timed.
const RESPONSE_POINTS: usize = 2_000;

pub fn run_group(session: &mut Session) {
    let scene = Scene::new(SubjectKind::Person, 7, VGA);
    let frame = Rig::new(&scene).publish(&scene.masks);
    let random = anywhere(&frame, INSIDE_POINTS);
    let surface: Vec<_> = Bodies::scattered(INSIDE_POINTS / 400, SAMPLES_400).world_points();

    let names = ["inside_random_over_literal", "inside_surface_over_literal"];
    let whats = [
        "points at random in the hull's box: inside or not",
        "samples of 60 boxes, box by box: inside or not",
    ];

    for ((points, name), (what, bound)) in
        [random, surface].iter().zip(names).zip(whats.into_iter().zip([14.6, 7.47]))
    {
        let bench = inside(&scene, &frame, points);
        let times = session.run(bench);
        session.bounded(name, times.ratio("literal", "ours"), Bound::AtLeast(bound), StartTime::Frame, what);
        let per_second = points.len() as f64 / times.seconds("ours") * 1e-6;
        session.reported(&name.replace("over_literal", "mpoints_per_s"), per_second, StartTime::Frame, what);
    }

    let near = at_depth(&frame, 1..=5, RESPONSE_POINTS);
    responses(session, "near", &scene, &frame, &near, "responses of points 1 to 5 pixels inside the person");

    // The person has no point so deep.
    let scene = Scene::new(SubjectKind::Barrel, 7, VGA);
    let frame = Rig::new(&scene).publish(&scene.masks);
    let deep = at_depth(&frame, 20..=60, RESPONSE_POINTS);
    responses(session, "deep", &scene, &frame, &deep, "responses of points 20 to 60 pixels inside a barrel");
}

fn inside<'a>(scene: &'a Scene, frame: &'a Frame, points: &[Point3<f64>]) -> PairedBench<'a> {
    let literal = LiteralHull::new(scene, frame.aabb());
    let (plain, batch) = (plain(points), Points::new(points));
    let mut workspace = Workspace::new();
    PairedBench::new()
        .with("literal", move || plain.iter().filter(|p| literal.inside(p)).count())
        .with("ours", move || frame.inside(&batch, &Isometry3::identity(), &mut workspace).count())
}

fn responses(
    session: &mut Session,
    name: &str,
    scene: &Scene,
    frame: &Frame,
    points: &[Point3<f64>],
    what: &'static str,
) {
    let times = session.run(respond(PairedBench::new(), name, scene, frame, points));
    let ratio = times.ratio(&format!("literal {name}"), &format!("ours {name}"));
    session.reported(&format!("response_{name}_over_literal"), ratio, StartTime::Frame, what);
    let per_second = points.len() as f64 / times.seconds(&format!("ours {name}")) * 1e-6;
    session.reported(&format!("response_{name}_mpoints_per_s"), per_second, StartTime::Frame, what);
}

/// Adds the literal program's and the library's responses of `points`. The candidates' names end with `label`.
pub fn respond<'a>(
    bench: PairedBench<'a>,
    label: &str,
    scene: &'a Scene,
    frame: &'a Frame,
    points: &[Point3<f64>],
) -> PairedBench<'a> {
    let literal = LiteralHull::new(scene, frame.aabb());
    let (plain, points) = (plain(points), points.to_vec());
    let mut workspace = Workspace::new();
    bench
        .with(format!("literal {label}"), move || {
            plain.iter().filter_map(|p| Some(literal.respond(p)?.w()[2])).sum::<f32>()
        })
        .with(format!("ours {label}"), move || frame.rise_of_responses(&points, &mut workspace))
}

/// `count` random points in the hull's bounding box.
fn anywhere(frame: &Frame, count: usize) -> Vec<Point3<f64>> {
    let mut random = Random(2);
    (0..count).map(|_| random.point(frame.aabb().min, frame.aabb().max)).collect()
}

/// `count` random points whose depth in pixels lies in `depths`, equally many of each depth.
pub fn at_depth(frame: &Frame, depths: std::ops::RangeInclusive<u16>, count: usize) -> Vec<Point3<f64>> {
    let mut random = Random(3);
    let mut missing = vec![count.div_ceil(depths.len()); depths.len()];
    let points = std::iter::repeat_with(|| random.point(frame.aabb().min, frame.aabb().max));
    let wanted = |p: &Point3<f64>| -> bool {
        let depth = frame.depth_px(p);
        let class = missing.get_mut(usize::from(depth.wrapping_sub(*depths.start())));
        class.filter(|missing| **missing > 0).map(|missing| *missing -= 1).is_some()
    };
    points.filter(wanted).take(count).collect()
}

fn plain(points: &[Point3<f64>]) -> Vec<Vec3> {
    points.iter().map(|p| p.coords.cast::<f32>().into()).collect()
}
