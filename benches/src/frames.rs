//! Whole frames, from masks to the literal program's body vectors and to our default contacts.

use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use ode_visual_hull_bench::literal::{LiteralBodies, LiteralHull};
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, FULL_HD, Given, Optics, SAMPLES_400, Scene, VGA, Who};
use ode_visual_hull_testing::figure::Bound;

const CONTACTS: &str = "masks in, default contacts out, boxes of 400 samples";
const RESPONSES: &str = "masks in, the paper's body vectors out, boxes of 400 samples";

/// The suffixes of the figures' names, and what the cameras look through.
pub const OPTICS: [(&str, Optics); 2] = [("", Optics::Pinholes), ("_lens", Optics::Lenses)];

pub fn measure(session: &mut Session) {
    // The bounds of the contacts, for pinholes and for lenses.
    let frames = [("vga", VGA, 60, [Some(3.5), Some(2.5)]), ("1080p", FULL_HD, 600, [None, None])];
    for (name, size, count, bounds) in frames {
        let bodies = Bodies::scattered(count, SAMPLES_400);
        for ((lens, optics), bound) in OPTICS.into_iter().zip(bounds) {
            let given = Given::new(Who::Person, 7, size, optics);
            over_literal(session, [&format!("{name}_{count}"), lens], &given, &bodies, bound);
        }
    }
}

/// Runs one comparison. Its figures are named after the frame and the `lens`.
fn over_literal(
    session: &mut Session,
    [frame, lens]: [&str; 2],
    input: &Given,
    bodies: &Bodies,
    bound: Option<f64>,
) {
    let bench = from_masks(PairedBench::new(), frame, input, bodies);
    let times = session.run(with_body_vectors(bench, "response", &input.ours, bodies));
    let [literal, contacts] = [format!("literal {frame}"), format!("ours {frame}")];

    let ratio = times.ratio(&literal, &contacts);
    let bound = bound.map(Bound::AtLeast);
    session.figure(&format!("contacts_{frame}_over_literal{lens}"), ratio, bound, StartTime::Masks, CONTACTS);
    let ratio = times.ratio(&literal, "response");
    session.reported(
        &format!("body_response_{frame}_over_literal{lens}"),
        ratio,
        StartTime::Masks,
        RESPONSES,
    );

    let milliseconds = |name: &str| 1e3 * times.seconds(name);
    session.reported(
        &format!("contacts_{frame}{lens}_ms"),
        milliseconds(&contacts),
        StartTime::Masks,
        CONTACTS,
    );
    let response = milliseconds("response");
    session.reported(&format!("body_response_{frame}{lens}_ms"), response, StartTime::Masks, RESPONSES);

    session.reported(
        &format!("literal_{frame}{lens}_ms"),
        milliseconds(&literal),
        StartTime::Masks,
        RESPONSES,
    );
}

/// Adds the literal program's body vectors and our default contacts, both from masks; `label` ends their names.
pub fn from_masks<'a>(
    bench: PairedBench<'a>,
    label: &str,
    given: &'a Given,
    bodies: &'a Bodies,
) -> PairedBench<'a> {
    let (rig, boxes, mut contacts) = (Rig::new(&given.ours), Boxes::new(bodies), Vec::new());
    let aabb = *rig.publish(&given.ours.masks).aabb();
    let (mut plain, mut vectors) = (LiteralBodies::new(bodies), Vec::new());
    bench
        .with(format!("literal {label}"), move || {
            plain.vectors(&LiteralHull::new(&given.rivals, &aabb), &mut vectors);
            vectors.len()
        })
        .with(format!("ours {label}"), move || {
            rig.publish(&given.ours.masks).contacts(&boxes, &mut contacts);
            contacts.len()
        })
}

/// Adds the literal program and our default contacts in a frame that is prepared already; `label` ends their names.
pub fn from_frame<'a>(
    bench: PairedBench<'a>,
    label: &str,
    input: &'a Given,
    bodies: &'a Bodies,
) -> PairedBench<'a> {
    let frame = Rig::new(&input.ours).publish(&input.ours.masks);
    let literal = LiteralHull::new(&input.rivals, frame.aabb());
    let (mut plain, mut vectors) = (LiteralBodies::new(bodies), Vec::new());
    let (boxes, mut contacts) = (Boxes::new(bodies), Vec::new());

    bench
        .with(format!("literal {label}"), move || {
            plain.vectors(&literal, &mut vectors);
            vectors.len()
        })
        .with(format!("ours {label}"), move || {
            frame.contacts(&boxes, &mut contacts);
            contacts.len()
        })
}

/// Adds our body vectors, from masks.
pub fn with_body_vectors<'a>(
    bench: PairedBench<'a>,
    name: &str,
    scene: &'a Scene,
    bodies: &'a Bodies,
) -> PairedBench<'a> {
    let (rig, boxes, mut vectors) = (Rig::new(scene), Boxes::new(bodies), Vec::new());
    bench.with(name, move || {
        rig.publish(&scene.masks).body_vectors(&boxes, &mut vectors);
        vectors.len()
    })
}
