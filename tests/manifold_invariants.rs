//! Contacts of random bodies in random poses on hulls of all kinds of rigs and masks: the short form of the
//! figures `manifolds`.

use ode_visual_hull_testing::manifolds::{collide_random, scenes};

#[test]
fn contacts_are_on_the_body_in_the_hull_as_deep_as_the_exit_and_the_same_in_any_order() {
    // All kinds of masks, lenses and policies appear among the first 14 scenes.
    let found = collide_random(&scenes(14, 1), 20_000, 2);
    assert_eq!(found.violations, 0, "{:#?}", found.examples);
    assert!(found.contacts >= 20_000 && found.compared.iter().all(|&count| count > 500), "{found:?}");
}
