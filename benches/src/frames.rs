//! Whole frames, from masks to the literal program's body vectors and to the library's default contacts.

use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use ode_visual_hull_bench::literal::{LiteralBodies, LiteralHull};
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, FULL_HD, Inputs, Optics, SAMPLES_400, Scene, SubjectKind, VGA};
use ode_visual_hull_testing::figure::Bound;

const CONTACTS: &str = "masks in, default contacts out, boxes of 400 samples";
const RESPONSES: &str = "masks in, the paper's body vectors out, boxes of 400 samples";

/// The cameras' optics, with the suffix that they give a figure's name.
pub const OPTICS: [(&str, Optics); 2] = [("", Optics::Pinholes), ("_lens", Optics::Lenses)];

pub fn run_group(session: &mut Session) {
    // The bounds on the contacts' figures: for pinholes, and for lenses.
    let frames = [("vga", VGA, 60, [Some(3.5), Some(2.5)]), ("1080p", FULL_HD, 600, [None, None])];
    for (name, size, count, bounds) in frames {
        let bodies = Bodies::scattered(count, SAMPLES_400);
        for ((lens, optics), bound) in OPTICS.into_iter().zip(bounds) {
            let input = Inputs::new(SubjectKind::Person, 7, size, optics);
            over_literal(session, [&format!("{name}_{count}"), lens], &input, &bodies, bound);
        }
    }
}

/// Compares one frame with the literal program. The figures are named after `frame` and `lens`.
fn over_literal(
    session: &mut Session,
    [frame, lens]: [&str; 2],
    input: &Inputs,
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

/// Adds the literal program's body vectors and the library's default contacts, both timed from the masks on. The
/// candidates' names end with `label`.
pub fn from_masks<'a>(
    bench: PairedBench<'a>,
    label: &str,
    input: &'a Inputs,
    bodies: &'a Bodies,
) -> PairedBench<'a> {
    let (rig, boxes, mut contacts) = (Rig::new(&input.ours), Boxes::new(bodies), Vec::new());
    let aabb = *rig.publish(&input.ours.masks).aabb();
    let (mut plain, mut vectors) = (LiteralBodies::new(bodies), Vec::new());

    bench
        .with(format!("literal {label}"), move || {
            plain.vectors(&LiteralHull::new(&input.peers, &aabb), &mut vectors);
            vectors.len()
        })
        .with(format!("ours {label}"), move || {
            rig.publish(&input.ours.masks).contacts(&boxes, &mut contacts);
            contacts.len()
        })
}

/// Adds the literal program's body vectors and the library's default contacts, both in a frame prepared beforehand. The
/// candidates' names end with `label`.
pub fn from_frame<'a>(
    bench: PairedBench<'a>,
    label: &str,
    input: &'a Inputs,
    bodies: &'a Bodies,
) -> PairedBench<'a> {
    let frame = Rig::new(&input.ours).publish(&input.ours.masks);
    let literal = LiteralHull::new(&input.peers, frame.aabb());
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

/// Adds the library's body vectors, timed from the masks on.
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
