//! The bodies of one frame, divided among threads.

use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, FULL_HD, SAMPLES_400, Scene, SubjectKind};
use ode_visual_hull_testing::figure::Bound;
use rayon::ThreadPoolBuilder;

pub fn run_group(session: &mut Session) {
    let scene = Scene::new(SubjectKind::Person, 7, FULL_HD);
    let frame = Rig::new(&scene).publish(&scene.masks);
    let boxes = Boxes::new(&Bodies::scattered(600, SAMPLES_400));
    let (frame, boxes) = (&frame, &boxes);

    // Both candidates wait for a pool's threads, so that both pay for handing the work over.
    let run = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        let mut contacts = Vec::new();
        move || pool.install(|| frame.contacts(boxes, &mut contacts))
    };
    let times = session.run(PairedBench::by_wall_clock().with("one", run(1)).with("two", run(2)));

    let what = "default contacts of 600 boxes at 1080p, two threads over one, by the wall clock";
    session.bounded(
        "threads_2_over_1",
        times.ratio("two", "one"),
        Bound::AtMost(0.6),
        StartTime::Frame,
        what,
    );
}
