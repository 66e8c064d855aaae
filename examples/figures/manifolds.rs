//! Invariants of contacts on random hulls and bodies: how many of a million contacts, and of the sets that
//! they are in, break one.

use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use ode_visual_hull_testing::manifolds::{collide_random, scenes};

/// Number of hulls: all kinds of masks with all lenses and policies, 4 x 5 x 3, and each with views that are
/// overruled.
const SCENES: usize = 84;

/// Number of contacts.
const CONTACTS: usize = 1_000_000;

/// `manifold_violations` of [`ode_visual_hull_testing::manifolds`], with its bound, and how often the order
/// of views or samples decides because of a tie.
pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("hulls");
    let scenes = scenes(SCENES, 1);
    progress(&format!("{CONTACTS} contacts"));
    let found = collide_random(&scenes, CONTACTS, 2);
    found.examples.iter().for_each(|example| progress(example));

    let share = |k: usize| found.ties[k] as f64 / found.compared[k].max(1) as f64;
    vec![
        Figure::bounded("manifold_violations", found.violations as f64, AtMost(0.0)),
        Figure::reported("manifold_contacts", found.contacts as f64),
        Figure::reported("manifold_orders_compared", (found.compared[0] + found.compared[1]) as f64),
        Figure::reported("manifold_tie_share", found.tie_share()),
        Figure::reported("manifold_tie_share_views", share(0)),
        Figure::reported("manifold_tie_share_samples", share(1)),
    ]
}
