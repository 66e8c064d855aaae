//! The default contacts, all their rules included, over the paper's body vectors.

use crate::figure::Bound;
use crate::survey::{Start, Survey};
use crate::timing::Race;
use ode_visual_hull::hull::Workspace;
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, SAMPLES_400, Scene, VGA, Who};

pub fn measure(survey: &mut Survey) {
    let scene = Scene::new(Who::Person, 7, VGA);
    let bodies = Bodies::scattered(60, SAMPLES_400);
    let rig = Rig::new(&scene);
    let (mut vectors, mut contacts) = (Vec::new(), Vec::new());
    let (boxes, mut workspace) = (Boxes::new(&bodies), Workspace::new());
    let race = Race::new()
        .with("paper", || {
            rig.publish(&scene.masks).body_vectors(&boxes, &mut vectors, &mut workspace);
            vectors.len()
        })
        .with("clustered", || {
            rig.publish(&scene.masks).contacts(&boxes, &mut contacts);
            contacts.len()
        });
    let times = survey.race(race);
    let what = "default contacts over the paper's body vectors, the same frame";
    let ratio = times.ratio("clustered", "paper");
    survey.asked("clustered_over_paper", ratio, Bound::AtMost(1.5), Start::Masks, what);
    let what = "masks in, default contacts out, 60 boxes of 400 samples";
    survey.reported("contacts_vga_60_ms", 1e3 * times.seconds("clustered"), Start::Masks, what);
}
