//! The renderer on a device draws what the renderer on the processor draws. Mesa's rasteriser is device enough.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData, Unseen};
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::synthetic::{self, Room, Subject, layout};
use ode_visual_hull_viewer::cpu::CpuRenderer;
use ode_visual_hull_viewer::gpu::{Device, GpuRenderer};
use ode_visual_hull_viewer::metrics::{intersection_over_union, psnr};
use ode_visual_hull_viewer::scene::{RealCameras, Scene};
use ode_visual_hull_viewer::{Content, DrawOptions, Method, Picture};

/// A person amid cameras of 320 x 240 pixels.
fn person(cameras: usize, unseen: Unseen) -> Scene {
    let middle = Point3::new(0.0, 0.0, 0.95);
    let cameras = layout::staggered(cameras, 3.0, &[1.0, 2.2], middle, (320, 240), 0.9).unwrap();
    let subject = Subject::person_at(0.3);
    let data = HullData::new();
    data.add_views(&cameras).unwrap();
    data.set_unseen(unseen).unwrap();
    data.set_bounds(Aabb::new(Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 2.2)).unwrap()).unwrap();
    let masks: Vec<_> = cameras.iter().map(|camera| synthetic::silhouette(camera, &subject)).collect();
    let hull = publish_masks(&data, &masks, 0.0).unwrap();
    let studio = synthetic::Scene { subject, room: Room::default() };
    let images: Vec<_> = cameras.iter().map(|camera| Some(synthetic::render(camera, &studio))).collect();
    RealCameras::new(&cameras).scene(&hull, images).unwrap()
}

/// Between the first two cameras.
fn viewpoint(size: (u32, u32)) -> Camera {
    Camera::look_at("eye", size, 0.9, Point3::new(2.6, 1.1, 1.6), Point3::new(0.0, 0.0, 0.95), Vector3::z())
        .unwrap()
}

fn options(method: Method) -> DrawOptions {
    DrawOptions { method, refine: false, shadows: false, surroundings: false, ..DrawOptions::default() }
}

fn device() -> Device {
    Device::new().unwrap_or_else(|error| panic!("{error}"))
}

fn renderer(scene: &Scene) -> GpuRenderer {
    let mut renderer = GpuRenderer::new(&device());
    renderer.set_scene(scene).unwrap();
    renderer
}

fn subject(picture: &Picture) -> Vec<bool> {
    picture.content.iter().map(|content| *content == Content::Subject).collect()
}

/// The device steps from other depths than the processor, so that a ray that grazes the hull by less than half a pixel may hit
/// or miss, and it blends 8-bit colours: two pixels in a thousand differ.
fn assert_alike(expected: &Picture, found: &Picture, what: &str) {
    let (a, b) = (subject(expected), subject(found));
    let overlap = intersection_over_union(&a, &b);
    assert!(overlap >= 0.995, "{what}: coverage agrees by {overlap}");
    let all = vec![true; a.len()];
    let found_psnr = psnr(&expected.colour, &found.colour, &all);
    assert!(found_psnr >= 38.0, "{what}: {found_psnr} dB");

    let depths = expected.depth.iter().zip(&found.depth).zip(a.iter().zip(&b));
    let off = depths.filter(|(_, (a, b))| **a && **b).map(|((a, b), _)| (a - b).abs());
    let mut off: Vec<f32> = off.collect();
    off.sort_by(f32::total_cmp);
    // Both find the surface to a pixel, 7 mm.
    assert!(off[off.len() * 9 / 10] < 0.01, "{what}: depths differ by {} m", off[off.len() * 9 / 10]);
}

#[test]
fn the_device_draws_what_the_processor_draws() {
    let scene = person(6, Unseen::Outside);
    let (mut device, processor) = (renderer(&scene), CpuRenderer::new(&scene));
    let camera = viewpoint((320, 240));
    for method in [Method::Blend, Method::Hull] {
        let options = options(method);
        let (expected, found) = (processor.draw(&camera, &options), device.draw(&camera, &options).unwrap());
        assert_alike(&expected, &found, &format!("{method:?}"));
    }
    let options = DrawOptions { refine: true, ..options(Method::Blend) };
    let (expected, found) = (processor.draw(&camera, &options), device.draw(&camera, &options).unwrap());
    assert_alike(&expected, &found, "refined");
}

#[test]
fn views_may_abstain_on_the_device_too() {
    let scene = person(6, Unseen::Abstain { min_views: 4 });
    let (camera, options) = (viewpoint((320, 240)), options(Method::Blend));
    let expected = CpuRenderer::new(&scene).draw(&camera, &options);
    assert_alike(&expected, &renderer(&scene).draw(&camera, &options).unwrap(), "abstaining views");
}

#[test]
fn pictures_may_have_any_size_and_scenes_any_number_of_views() {
    let mut device = GpuRenderer::new(&device());
    for (views, size) in [(1, (101, 67)), (3, (33, 250)), (5, (7, 5))] {
        let scene = person(views, Unseen::Outside);
        device.set_scene(&scene).unwrap();
        let (camera, options) = (viewpoint(size), options(Method::Blend));
        let expected = subject(&CpuRenderer::new(&scene).draw(&camera, &options));
        let found = subject(&device.draw(&camera, &options).unwrap());
        let differing = expected.iter().zip(&found).filter(|(a, b)| a != b).count();
        // Of small pictures more pixels lie at the outline.
        assert!(differing * 50 <= expected.len(), "{differing} of {} pixels differ", expected.len());
    }
}

#[test]
fn a_sweep_covers_the_hull_without_holes() {
    let scene = person(6, Unseen::Outside);
    let mut device = renderer(&scene);
    let camera = viewpoint((320, 240));
    let hull = device.draw(&camera, &options(Method::Hull)).unwrap();
    for planes in [1, 100] {
        let sweep = device.draw(&camera, &DrawOptions { planes, ..options(Method::Sweep) }).unwrap();
        assert_eq!(sweep.content, hull.content);
        // The photo hull lies in the visual hull. Planes find what is thinner than the steps along a ray.
        let in_front =
            sweep.depth.iter().zip(&hull.depth).filter(|(sweep, hull)| **sweep < **hull - 0.01).count();
        let covered = subject(&hull).iter().filter(|is_subject| **is_subject).count();
        assert!(in_front * 200 <= covered, "{in_front} of {covered} pixels lie in front of the hull");
    }
}

#[test]
fn a_sweep_that_begins_at_the_hull_draws_what_one_over_all_planes_draws() {
    let scene = person(6, Unseen::Outside);
    let mut device = renderer(&scene);
    let camera = viewpoint((320, 240));
    let mut sweep =
        |cull_planes| device.draw(&camera, &DrawOptions { cull_planes, ..options(Method::Sweep) }).unwrap();
    let (culled, plain) = (sweep(true), sweep(false));
    // They differ where a ray is in the hull between two planes alone: at its outline.
    let (a, b) = (subject(&culled), subject(&plain));
    assert!(intersection_over_union(&a, &b) > 0.97, "{}", intersection_over_union(&a, &b));
    let both: Vec<bool> = a.iter().zip(&b).map(|(a, b)| *a && *b).collect();
    let found = psnr(&culled.colour, &plain.colour, &both);
    assert!(found > 30.0, "{found} dB");
}

#[test]
fn a_picture_is_the_same_when_it_is_drawn_again() {
    let (scene, other) = (person(6, Unseen::Outside), person(4, Unseen::Outside));
    let mut device = renderer(&scene);
    let camera = viewpoint((320, 240));
    for method in [Method::Blend, Method::Sweep, Method::Hull] {
        let options = options(method);
        let first = device.draw(&camera, &options).unwrap();
        assert_eq!(device.draw(&camera, &options).unwrap(), first, "{method:?}");
        // Another scene and another size leave nothing behind.
        device.set_scene(&other).unwrap();
        device.draw(&viewpoint((64, 48)), &options).unwrap();
        device.set_scene(&scene).unwrap();
        assert_eq!(device.draw(&camera, &options).unwrap(), first, "{method:?}");
    }
}

#[test]
fn a_camera_that_looks_away_sees_no_subject() {
    let scene = person(4, Unseen::Outside);
    let eye = Point3::new(2.6, 1.1, 1.6);
    let away = Camera::look_at("eye", (64, 48), 0.9, eye, Point3::new(5.0, 2.0, 1.6), Vector3::z()).unwrap();
    let mut device = renderer(&scene);
    for method in [Method::Blend, Method::Sweep, Method::Hull] {
        assert_eq!(device.draw(&away, &options(method)).unwrap(), Picture::new(64, 48), "{method:?}");
    }
}

#[test]
fn a_lost_device_is_an_error() {
    let scene = person(3, Unseen::Outside);
    let device = device();
    let mut renderer = GpuRenderer::new(&device);
    renderer.set_scene(&scene).unwrap();
    device.destroy();
    let camera = viewpoint((64, 48));
    for _ in 0..2 {
        let error = renderer.draw(&camera, &options(Method::Blend)).unwrap_err().to_string();
        assert!(error.contains("lost"), "{error}");
    }
    assert!(renderer.set_scene(&scene).is_err());
    GpuRenderer::new(&device).set_scene(&scene).unwrap_err();
}

#[test]
fn what_a_device_cannot_draw_is_an_error() {
    let scene = person(3, Unseen::Outside);
    let device = device();
    let mut renderer = GpuRenderer::new(&device);
    let error = renderer.draw(&viewpoint((64, 48)), &options(Method::Hull)).unwrap_err().to_string();
    assert!(error.contains("scene"), "{error}");
    renderer.set_scene(&scene).unwrap();
    let error = renderer.draw(&viewpoint((64, 60_000)), &options(Method::Hull)).unwrap_err().to_string();
    assert!(error.contains("60000"), "{error}");
    assert!(renderer.draw(&viewpoint((64, 48)), &options(Method::Hull)).is_ok(), "it draws again");
}
