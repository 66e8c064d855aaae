//! Rays and exits along lines on which a depth, an image coordinate or its change is zero but for rounding, held against
//! inside tests of points on them: how many are wrong, on two captures and in a synthetic scene.

use ode_visual_hull::hull::{Hull, Unseen};
use ode_visual_hull_testing::captures::{self, BALANCING, SEATED};
use ode_visual_hull_testing::degenerate_lines::{Kind, Lines, contradiction};
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::quality::scene;
use ode_visual_hull_testing::random::Random;

/// Number of lines of each kind in each hull: with the ten kinds and four hulls a hundred thousand.
const LINES: usize = 2500;

/// `line_of_sight_misses`, the number of lines of every kind along which an answer is wrong, with its bound; likewise for
/// each hull and each kind of line; and how many lines were asked. Captures that are absent are left out.
pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut hulls = vec![("torus_7", scene::scene("torus", 7).coverage)];
    for (name, capture, frame, bounds, unseen) in [
        ("seated_person", "seated_person", 0, SEATED, Unseen::Outside),
        ("seated_person_abstain", "seated_person", 0, SEATED, Unseen::ABSTAIN),
        ("balancing_person", "balancing_person", 50, BALANCING, Unseen::Outside),
    ] {
        if let Some(dir) = captures::find(capture) {
            hulls.push((name, Hull::clone(&captures::hull_of(&dir, frame, bounds, unseen))));
        }
    }

    let mut figures = Vec::new();
    let mut by_kind = Kind::ALL.map(|_| 0);
    for (name, hull) in &hulls {
        progress(name);
        let wrong = count_wrong(hull);
        figures.push(Figure::reported(
            &format!("line_of_sight_misses_{name}"),
            wrong.iter().sum::<usize>() as f64,
        ));
        by_kind.iter_mut().zip(wrong).for_each(|(sum, wrong)| *sum += wrong);
    }

    let kinds = Kind::ALL.iter().zip(by_kind);
    figures.extend(kinds.map(|(kind, wrong)| {
        Figure::reported(
            &format!("line_of_sight_misses_{}", format!("{kind:?}").to_lowercase()),
            wrong as f64,
        )
    }));
    let asked = LINES * Kind::ALL.len() * hulls.len();
    figures.push(Figure::reported("line_of_sight_misses_asked", asked as f64));
    let wrong: usize = by_kind.iter().sum();
    figures.push(Figure::bounded("line_of_sight_misses", wrong as f64, Bound::AtMost(0.0)));

    figures
}

/// Number of lines of each kind along which an answer is wrong.
fn count_wrong(hull: &Hull) -> [usize; 10] {
    let (mut lines, mut random) = (Lines::new(hull, 1), Random(2));
    Kind::ALL.map(|kind| {
        let is_wrong = |_: &usize| contradiction(hull, &lines.along(kind), &mut random).is_some();
        (0..LINES).filter(is_wrong).count()
    })
}
