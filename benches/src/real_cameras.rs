//! The extra cost of real cameras: lenses, views that abstain, and masks with coverage.
//!
//! Seven views see the person, with 60 boxes of 400 samples around. Each figure compares the library with itself at one
//! frame size, and a second figure reports the time of the real case.

use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use ode_visual_hull_bench::ours::{Boxes, Frame, Rig};
use ode_visual_hull_bench::scene::{Bodies, FULL_HD, SAMPLES_400, Scene, SubjectKind, VGA};
use ode_visual_hull_testing::figure::Bound;

pub fn run_group(session: &mut Session) {
    let boxes = Boxes::new(&Bodies::scattered(60, SAMPLES_400));
    for (name, size) in [("vga", VGA), ("1080p", FULL_HD)] {
        let pinhole = Scene::new(SubjectKind::Person, 7, size);
        let lens = Scene::through_lenses(SubjectKind::Person, 7, size);
        lens_contacts(session, name, &pinhole, &lens, &boxes);
        abstain_contacts(session, name, &pinhole, &boxes);
        coverage_contacts(session, name, &Scene::segmented(SubjectKind::Person, 7, size), &boxes);
        lens_prepare(session, name, &pinhole, &lens);
    }
    overruled_contacts(session, &Scene::new(SubjectKind::Person, 7, VGA), &boxes);
    body_response(session, &Scene::new(SubjectKind::Person, 7, VGA), &boxes);
}

/// Adds the default contacts of `boxes` in a prepared frame.
fn with_contacts<'a>(bench: PairedBench<'a>, name: &str, frame: Frame, boxes: &'a Boxes) -> PairedBench<'a> {
    let mut contacts = Vec::new();
    bench.with(name, move || {
        frame.contacts(boxes, &mut contacts);
        contacts.len()
    })
}

/// Compares contacts in views with lenses with contacts in pinhole views.
fn lens_contacts(session: &mut Session, name: &str, pinhole: &Scene, lens: &Scene, boxes: &Boxes) {
    let frame = |scene: &Scene| Rig::new(scene).publish(&scene.masks);
    let bench = with_contacts(PairedBench::new(), "pinhole", frame(pinhole), boxes);
    let times = session.run(with_contacts(bench, "lens", frame(lens), boxes));

    let what = "default contacts, lenses with k1 = -0.2 over pinhole cameras, binary masks";
    let ratio = times.ratio("lens", "pinhole");
    session.bounded(
        &format!("lens_contacts_over_pinhole_{name}"),
        ratio,
        Bound::AtMost(1.3),
        StartTime::Frame,
        what,
    );

    let what = "default contacts behind such lenses";

    session.reported(
        &format!("lens_contacts_{name}_ms"),
        1e3 * times.seconds("lens"),
        StartTime::Frame,
        what,
    );
}

/// Compares contacts in views that abstain with contacts in views that count as outside what they do not see.
fn abstain_contacts(session: &mut Session, name: &str, scene: &Scene, boxes: &Boxes) {
    let outside = Rig::new(scene).publish(&scene.masks);
    let abstain = Rig::abstaining(scene).publish(&scene.masks);
    let bench = with_contacts(PairedBench::new(), "outside", outside, boxes);
    let times = session.run(with_contacts(bench, "abstain", abstain, boxes));

    let what = "default contacts, views that abstain over views that cut the hull off";
    let ratio = times.ratio("abstain", "outside");
    let figure = format!("abstain_contacts_over_outside_{name}");
    session.bounded(&figure, ratio, Bound::AtMost(1.5), StartTime::Frame, what);

    let what = "default contacts with views that abstain";

    session.reported(
        &format!("abstain_contacts_{name}_ms"),
        1e3 * times.seconds("abstain"),
        StartTime::Frame,
        what,
    );
}

/// Compares contacts from masks with coverage with contacts from binary masks. Each frame is new, so that no edge
/// normal is cached yet.
fn coverage_contacts(session: &mut Session, name: &str, coverage: &Scene, boxes: &Boxes) {
    let binary = coverage.binary();
    let mut bench = PairedBench::new();
    for (name, scene) in [("binary", &binary), ("coverage", coverage)] {
        let (rig, mut contacts) = (Rig::new(scene), Vec::new());
        bench = bench.with_prepared(
            name,
            move || rig.publish(&scene.masks),
            move |frame| {
                frame.contacts(boxes, &mut contacts);
                contacts.len()
            },
        );
    }

    let times = session.run(bench);

    let what = "default contacts in a new frame, segmented masks with coverage over the same made binary";
    let ratio = times.ratio("coverage", "binary");
    let figure = format!("coverage_contacts_over_binary_{name}");
    session.bounded(&figure, ratio, Bound::AtMost(1.6), StartTime::Frame, what);

    let what = "default contacts in a new frame of segmented masks with coverage";
    let milliseconds = 1e3 * times.seconds("coverage");

    session.reported(&format!("coverage_contacts_{name}_ms"), milliseconds, StartTime::Frame, what);
}

/// Compares contacts in a hull in which one view may be overruled with contacts in a hull in which none is.
fn overruled_contacts(session: &mut Session, scene: &Scene, boxes: &Boxes) {
    let plain = Rig::new(scene).publish(&scene.masks);
    let overruling = plain.overruling(0.02);
    let bench = with_contacts(PairedBench::new(), "plain", plain, boxes);
    let times = session.run(with_contacts(bench, "overruling", overruling, boxes));

    let what =
        "default contacts, one view overruled where all others are 2 cm deeper, over contacts of all views";
    let ratio = times.ratio("overruling", "plain");
    session.reported("overruled_contacts_over_plain_vga", ratio, StartTime::Frame, what);
}

/// Compares preparing masks of views with lenses with preparing masks of pinhole views.
fn lens_prepare(session: &mut Session, name: &str, pinhole: &Scene, lens: &Scene) {
    let (pinhole_rig, lens_rig) = (Rig::new(pinhole), Rig::new(lens));
    let bench = PairedBench::new()
        .with("pinhole", || pinhole_rig.publish(&pinhole.masks))
        .with("lens", || lens_rig.publish(&lens.masks));
    let times = session.run(bench);

    let what = "seven masks prepared, lenses with k1 = -0.2 over pinhole cameras";
    let ratio = times.ratio("lens", "pinhole");
    session.bounded(
        &format!("lens_prepare_over_pinhole_{name}"),
        ratio,
        Bound::AtMost(3.0),
        StartTime::Masks,
        what,
    );

    let what = "seven masks prepared behind such lenses";

    session.reported(&format!("lens_prepare_{name}_ms"), 1e3 * times.seconds("lens"), StartTime::Masks, what);
}

/// Compares the paper's body vectors with the default contacts.
fn body_response(session: &mut Session, scene: &Scene, boxes: &Boxes) {
    let frame = Rig::new(scene).publish(&scene.masks);
    let mut vectors = Vec::new();
    let bench = with_contacts(PairedBench::new(), "contacts", frame.clone(), boxes).with("response", || {
        frame.body_vectors(boxes, &mut vectors);
        vectors.len()
    });
    let times = session.run(bench);

    let what = "the paper's body vectors of 60 boxes over the default contacts";
    let ratio = times.ratio("response", "contacts");
    session.bounded("body_response_over_contacts", ratio, Bound::AtMost(1.2), StartTime::Frame, what);
    let what = "the paper's body vectors of 60 boxes, VGA";

    session.reported("body_response_vga_ms", 1e3 * times.seconds("response"), StartTime::Frame, what);
}
