//! Preparing a frame, from its masks until the first query can be answered.

use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use image::GrayImage;
use ode_visual_hull::silhouette::PackedMask;
use ode_visual_hull_bench::ours::Rig;
use ode_visual_hull_bench::scene::{FULL_HD, Scene, SubjectKind, VGA};

pub fn run_group(session: &mut Session) {
    let what = "seven masks prepared, in milliseconds";
    for (name, size) in [("vga", VGA), ("1080p", FULL_HD)] {
        let scene = Scene::new(SubjectKind::Person, 7, size);
        let rig = Rig::new(&scene);

        let bench = PairedBench::new()
            .with("prepare", || rig.publish(&scene.masks))
            .with("read", || scene.masks.iter().map(largest_byte).max());
        let times = session.run(bench);
        session.reported(
            &format!("prepare_{name}_ms"),
            1e3 * times.seconds("prepare"),
            StartTime::Masks,
            what,
        );

        let what = "preparing a frame over one plain read of its masks";
        let ratio = times.ratio("prepare", "read");
        session.reported(&format!("prepare_over_memory_read_{name}"), ratio, StartTime::Masks, what);
    }
    packed_masks(session);
}

/// Compares handing segmented masks to the hull packed with handing them over as bytes.
fn packed_masks(session: &mut Session) {
    let scene = Scene::segmented(SubjectKind::Person, 7, VGA);
    let rig = Rig::new(&scene);
    let packed: Vec<_> = scene.masks.iter().map(PackedMask::new).collect();
    let mut bytes = scene.masks.clone();
    let bench = PairedBench::new().with("packed", || rig.publish_packed(&packed)).with("bytes", || {
        packed.iter().zip(&mut bytes).for_each(|(packed, bytes)| packed.write_to(bytes));
        rig.publish(&bytes)
    });
    let times = session.run(bench);
    let what = "seven packed masks with coverage prepared, over doing so by way of bytes";
    session.reported("packed_over_bytes", times.ratio("packed", "bytes"), StartTime::Masks, what);
}

/// The largest byte of a mask, a measure of the time that reading it takes.
fn largest_byte(mask: &GrayImage) -> u8 {
    mask.as_raw().iter().fold(0, |most, &byte| most.max(byte))
}
