//! Times of the library's parts: `cargo bench -p ode-visual-hull-bench`.
//!
//! Seven views see a person, at VGA where no size is given. Times are of a whole batch, beside its item count.

use divan::{Bencher, black_box, counter::ItemsCount};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::hull::{EdgeModel, Points, Workspace};
use ode_visual_hull_bench::ours::{Boxes, Frame, Rig};
use ode_visual_hull_bench::scene::{
    Bodies, FULL_HD, SAMPLES_400, SAMPLES_4000, Scene, SubjectKind, UHD, VGA,
};
use ode_visual_hull_testing::random::Random;

const SIZES: [(u32, u32); 3] = [VGA, FULL_HD, UHD];

fn main() {
    divan::main();
}

fn person() -> Frame {
    let scene = Scene::new(SubjectKind::Person, 7, VGA);
    Rig::new(&scene).publish(&scene.masks)
}

/// 1000 random points inside the hull.
fn points_inside(frame: &Frame) -> Vec<Point3<f64>> {
    let mut random = Random(11);
    let points = std::iter::repeat_with(|| random.point(frame.aabb().min, frame.aabb().max));
    points.filter(|p| frame.hull().inside(p)).take(1000).collect()
}

#[divan::bench(args = SIZES, max_time = 2)]
fn prepare_seven_masks(bencher: Bencher, size: &(u32, u32)) {
    let scene = Scene::new(SubjectKind::Person, 7, *size);
    let rig = Rig::new(&scene);
    bencher.bench_local(|| rig.publish(&scene.masks));
}

#[divan::bench(args = SIZES, max_time = 2)]
fn prepare_seven_masks_behind_lenses(bencher: Bencher, size: &(u32, u32)) {
    let scene = Scene::through_lenses(SubjectKind::Person, 7, *size);
    let rig = Rig::new(&scene);
    bencher.bench_local(|| rig.publish(&scene.masks));
}

#[divan::bench]
fn inside(bencher: Bencher) {
    let frame = person();
    let points = Bodies::scattered(60, SAMPLES_400).world_points();
    let (count, points) = (ItemsCount::new(points.len()), Points::new(&points));
    let mut workspace = Workspace::new();
    bencher
        .counter(count)
        .bench_local(|| frame.inside(&points, &Isometry3::identity(), &mut workspace).count());
}

#[divan::bench]
fn respond(bencher: Bencher) {
    let frame = person();
    let points = points_inside(&frame);
    let mut workspace = Workspace::new();
    bencher
        .counter(ItemsCount::new(points.len()))
        .bench_local(|| frame.rise_of_responses(&points, &mut workspace));
}

#[divan::bench(args = [EdgeModel::Pixel, EdgeModel::Coverage])]
fn exit(bencher: Bencher, edge: &EdgeModel) {
    let frame = person();
    let points = points_inside(&frame);
    let direction = Vector3::new(0.6, 0.64, 0.48);
    bencher.counter(ItemsCount::new(points.len())).bench_local(|| {
        points.iter().map(|p| frame.hull().exit(black_box(p), &direction, *edge)).sum::<f64>()
    });
}

#[divan::bench(args = [SAMPLES_400, SAMPLES_4000])]
fn body_vectors_of_60_boxes(bencher: Bencher, min_feature: f64) {
    let frame = person();
    let boxes = Boxes::new(&Bodies::scattered(60, min_feature));
    let mut vectors = Vec::new();
    bencher.bench_local(|| frame.body_vectors(&boxes, &mut vectors));
}

#[divan::bench(args = [SAMPLES_400, SAMPLES_4000])]
fn contacts_of_60_boxes(bencher: Bencher, min_feature: f64) {
    let frame = person();
    let boxes = Boxes::new(&Bodies::scattered(60, min_feature));
    let mut contacts = Vec::new();
    bencher.bench_local(|| frame.contacts(&boxes, &mut contacts));
}

#[divan::bench(args = [VGA, FULL_HD], max_time = 2)]
fn contacts_of_60_boxes_behind_lenses(bencher: Bencher, size: &(u32, u32)) {
    let scene = Scene::through_lenses(SubjectKind::Person, 7, *size);
    contacts_in(bencher, &Rig::new(&scene).publish(&scene.masks));
}

#[divan::bench(args = [VGA, FULL_HD], max_time = 2)]
fn contacts_of_60_boxes_where_views_abstain(bencher: Bencher, size: &(u32, u32)) {
    let scene = Scene::new(SubjectKind::Person, 7, *size);
    contacts_in(bencher, &Rig::abstaining(&scene).publish(&scene.masks));
}

/// Times the contacts of 60 boxes in one frame.
fn contacts_in(bencher: Bencher, frame: &Frame) {
    let boxes = Boxes::new(&Bodies::scattered(60, SAMPLES_400));
    let mut contacts = Vec::new();
    bencher.bench_local(|| frame.contacts(&boxes, &mut contacts));
}

#[divan::bench(args = [VGA, FULL_HD], max_time = 2, sample_size = 1)]
fn contacts_of_60_boxes_in_new_binary_frames(bencher: Bencher, size: &(u32, u32)) {
    contacts_in_new_frames(bencher, &Scene::segmented(SubjectKind::Person, 7, *size).binary());
}

#[divan::bench(args = [VGA, FULL_HD], max_time = 2, sample_size = 1)]
fn contacts_of_60_boxes_in_new_frames_with_coverage(bencher: Bencher, size: &(u32, u32)) {
    contacts_in_new_frames(bencher, &Scene::segmented(SubjectKind::Person, 7, *size));
}

/// Times the contacts of 60 boxes in new frames, which have no cached edge normals yet. A sample is one frame, made
/// just before without being timed: most of many frames made in advance would have left the processor's caches.
fn contacts_in_new_frames(bencher: Bencher, scene: &Scene) {
    let boxes = Boxes::new(&Bodies::scattered(60, SAMPLES_400));
    let (rig, mut contacts) = (Rig::new(scene), Vec::new());
    bencher
        .with_inputs(|| rig.publish(&scene.masks))
        .bench_local_values(|frame| frame.contacts(&boxes, &mut contacts));
}
