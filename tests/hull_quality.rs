//! The hull from pixels compared with the analytic hull of its cameras: the quick part of `examples/figures`.

use ode_visual_hull::hull::EdgeModel;
use ode_visual_hull_testing::quality::accuracy::{self, exit_errors_px, mean, p99};
use ode_visual_hull_testing::quality::scene::{self, Scene};
use std::sync::LazyLock;

static SCENES: LazyLock<[Scene; 3]> =
    LazyLock::new(|| [("sphere", 5), ("box", 7), ("torus", 5)].map(|(shape, n)| scene::scene(shape, n)));

/// Asserts that the figure of every scene holds. A failure names the scene.
fn assert_everywhere(figure: impl Fn(&Scene) -> f64, holds: impl Fn(f64) -> bool) {
    for scene in SCENES.iter() {
        let value = figure(scene);
        assert!(holds(value), "{}: {value}", scene.name);
    }
}

#[test]
fn the_inside_test_agrees_with_the_analytic_hull_a_pixel_away_from_contours() {
    assert_everywhere(|scene| accuracy::inside_agreement(scene, 4000, 2), |share| share == 1.0);
}

#[test]
fn responses_equal_the_references() {
    assert_everywhere(|scene| accuracy::reference_agree(scene, 50, 4), |share| share >= 0.999);
}

#[test]
fn points_moved_by_their_responses_are_outside() {
    assert_everywhere(|scene| accuracy::response_leaves(scene, 2000, 5), |share| share >= 0.999);
}

/// Edges of binary masks are exact to half a pixel's side, or half its diagonal; coverage locates them within the
/// pixel.
#[test]
fn exits_lie_on_the_analytic_surface() {
    for scene in SCENES.iter() {
        let probes = accuracy::probes(scene, 200, 1);
        let binary = exit_errors_px(scene, &scene.binary, EdgeModel::Pixel, &probes);
        assert!(mean(&binary) <= 0.3 && p99(&binary) <= 0.7, "{}: {}", scene.name, mean(&binary));
        let coverage = exit_errors_px(scene, &scene.coverage, EdgeModel::Coverage, &probes);
        assert!(mean(&coverage) <= 0.08 && p99(&coverage) <= 0.2, "{}: {}", scene.name, mean(&coverage));
    }
}
