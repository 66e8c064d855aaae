//! The geometric figures: the hull from pixels, compared with the analytic hull of its cameras.

use Bound::{AtLeast, AtMost};
use ode_visual_hull::hull::EdgeModel;
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::quality::accuracy::{self, NormalError, Probe, mean, p99, share};
use ode_visual_hull_testing::quality::scene::{self, Scene};
use std::collections::BTreeMap;

/// The figures of a scene, with the bounds on the worst scene.
const BOUNDS: [(&str, Option<Bound>); 15] = [
    ("inside_agreement", Some(AtLeast(1.0))),
    ("culls_agree", Some(AtLeast(1.0))),
    ("reference_agree", Some(AtLeast(0.999))),
    ("response_leaves", Some(AtLeast(0.999))),
    ("exit_error_px_mean", Some(AtMost(0.3))),
    ("exit_error_px_p99", Some(AtMost(0.7))),
    ("exit_error_coverage_px_mean", Some(AtMost(0.08))),
    ("exit_error_coverage_px_p99", Some(AtMost(0.2))),
    ("paper_normal_error_deg_mean", Some(AtMost(7.0))),
    ("contact_normal_error_deg_mean", Some(AtMost(4.0))),
    ("contact_normal_error_coverage_deg_mean", Some(AtMost(3.5))),
    ("normals_away_from_edges_share", None),
    ("paper_normal_error_everywhere_deg_mean", None),
    ("contact_normal_error_everywhere_deg_mean", None),
    ("contact_normal_error_coverage_everywhere_deg_mean", None),
];

/// Every figure of each scene, as `name_torus_7`, and the worst over all scenes as `name`, with its bound.
pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut by_scene = Vec::new();
    for scene in scene::all() {
        progress(&scene.name);
        by_scene.push((scene.name.clone(), measure_scene(&scene)));
    }

    let mut figures = Vec::new();
    for (name, bound) in BOUNDS {
        let values = by_scene.iter().map(|(_, measured)| measured[name]);
        figures.push(Figure { name: name.into(), value: worst(values, bound), bound });
        figures.extend(by_scene.iter().map(|(scene, measured)| Figure {
            name: format!("{name}_{scene}"),
            value: measured[name],
            bound: None,
        }));
    }

    figures
}

/// The worst value with respect to the bound, or the mean where there is no bound; NaN if any value is NaN.
fn worst(values: impl Iterator<Item = f64>, bound: Option<Bound>) -> f64 {
    let values: Vec<f64> = values.collect();
    if values.iter().any(|value| value.is_nan()) {
        return f64::NAN;
    }
    match bound {
        Some(AtLeast(_)) => values.into_iter().fold(f64::INFINITY, f64::min),
        Some(_) => values.into_iter().fold(f64::NEG_INFINITY, f64::max),
        None => mean(&values),
    }
}

fn measure_scene(scene: &Scene) -> BTreeMap<&'static str, f64> {
    let probes = accuracy::probes(scene, 2000, 1);
    let paper = accuracy::paper_normal_errors(scene, &probes);
    let contact = accuracy::contact_normal_errors(scene, &scene.binary, &probes);
    let contact_coverage = accuracy::contact_normal_errors(scene, &scene.coverage, &probes);

    let mut figures = BTreeMap::from([
        ("inside_agreement", accuracy::inside_agreement(scene, 100_000, 2)),
        ("culls_agree", accuracy::culls_agree(scene, 4000, 3)),
        ("reference_agree", accuracy::reference_agree(scene, 1000, 4)),
        ("response_leaves", accuracy::response_leaves(scene, 10_000, 5)),
        ("paper_normal_error_deg_mean", away_from_edges(&paper)),
        ("contact_normal_error_deg_mean", away_from_edges(&contact)),
        ("contact_normal_error_coverage_deg_mean", away_from_edges(&contact_coverage)),
        ("normals_away_from_edges_share", share(contact.iter().map(|error| !error.near_edge))),
        ("paper_normal_error_everywhere_deg_mean", everywhere(&paper)),
        ("contact_normal_error_everywhere_deg_mean", everywhere(&contact)),
        ("contact_normal_error_coverage_everywhere_deg_mean", everywhere(&contact_coverage)),
    ]);

    figures.extend(exit_figures(scene, &probes));

    figures
}

fn exit_figures(scene: &Scene, probes: &[Probe]) -> [(&'static str, f64); 4] {
    let binary = accuracy::exit_errors_px(scene, &scene.binary, EdgeModel::Pixel, probes);
    let coverage = accuracy::exit_errors_px(scene, &scene.coverage, EdgeModel::Coverage, probes);
    [
        ("exit_error_px_mean", mean(&binary)),
        ("exit_error_px_p99", p99(&binary)),
        ("exit_error_coverage_px_mean", mean(&coverage)),
        ("exit_error_coverage_px_p99", p99(&coverage)),
    ]
}

fn away_from_edges(errors: &[NormalError]) -> f64 {
    let away = errors.iter().filter(|error| !error.near_edge).map(|error| error.degrees);
    mean(&away.collect::<Vec<_>>())
}

fn everywhere(errors: &[NormalError]) -> f64 {
    mean(&errors.iter().map(|error| error.degrees).collect::<Vec<_>>())
}
