//! Whole frames: masks in, the paper's vector of each body out.

use crate::figure::Bound;
use crate::survey::{Start, Survey};
use crate::timing::Race;
use ode_visual_hull::hull::Workspace;
use ode_visual_hull_bench::literal::{LiteralBodies, LiteralHull};
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, FULL_HD, SAMPLES_400, Scene, VGA, Who};

pub fn measure(survey: &mut Survey) {
    let frames = [("vga", VGA, 60, 9.0), ("1080p", FULL_HD, 600, 30.0)];
    for (name, size, count, bound) in frames {
        let scene = Scene::new(Who::Person, 7, size);
        let bodies = Bodies::scattered(count, SAMPLES_400);
        let times = survey.race(from_masks(Race::new(), name, &scene, &bodies));
        let what = "masks in, the paper's body vectors out, boxes of 400 samples";
        let ratio = times.ratio(&format!("literal {name}"), &format!("ours {name}"));
        let seconds = [times.seconds(&format!("ours {name}")), times.seconds(&format!("literal {name}"))];
        let name = format!("frame_{name}_{count}");
        survey.asked(&format!("{name}_over_literal"), ratio, Bound::AtLeast(bound), Start::Masks, what);
        survey.reported(&format!("{name}_ms"), 1e3 * seconds[0], Start::Masks, what);
        survey.reported(&format!("{name}_literal_ms"), 1e3 * seconds[1], Start::Masks, what);
    }
}

/// Adds the paper's body vectors, from the masks on, by the literal program and by ours; `label` ends their names.
pub fn from_masks<'a>(race: Race<'a>, label: &str, scene: &'a Scene, bodies: &'a Bodies) -> Race<'a> {
    let rig = Rig::new(scene);
    let aabb = *rig.publish(&scene.masks).aabb();
    let mut plain = LiteralBodies::new(bodies);
    let (mut literal_vectors, mut vectors) = (Vec::new(), Vec::new());
    let (boxes, mut workspace) = (Boxes::new(bodies), Workspace::new());
    race.with(format!("literal {label}"), move || {
        plain.vectors(&LiteralHull::new(scene, &aabb), &mut literal_vectors);
        literal_vectors.len()
    })
    .with(format!("ours {label}"), move || {
        rig.publish(&scene.masks).body_vectors(&boxes, &mut vectors, &mut workspace);
        vectors.len()
    })
}

/// The same in frames that are prepared already.
pub fn from_frame<'a>(race: Race<'a>, label: &str, scene: &'a Scene, bodies: &'a Bodies) -> Race<'a> {
    let frame = Rig::new(scene).publish(&scene.masks);
    let literal = LiteralHull::new(scene, frame.aabb());
    let mut plain = LiteralBodies::new(bodies);
    let (mut literal_vectors, mut vectors) = (Vec::new(), Vec::new());
    let (boxes, mut workspace) = (Boxes::new(bodies), Workspace::new());
    race.with(format!("literal {label}"), move || {
        plain.vectors(&literal, &mut literal_vectors);
        literal_vectors.len()
    })
    .with(format!("ours {label}"), move || {
        frame.body_vectors(&boxes, &mut vectors, &mut workspace);
        vectors.len()
    })
}
