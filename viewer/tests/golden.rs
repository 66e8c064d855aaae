//! Pictures are those that were looked at and committed.
//!
//! `RECORD_GOLDEN=1 cargo test -p ode-visual-hull-viewer --test golden` draws them again; look at them before you commit.

use image::RgbImage;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_film::Drawn;
use ode_visual_hull_testing::rendered::Rendered;
use ode_visual_hull_viewer::orbit::Orbit;
use ode_visual_hull_viewer::scene::{RealCameras, Scene};
use ode_visual_hull_viewer::{DrawOptions, Method, Picture, Renderer, RendererKind};
use std::path::PathBuf;
use std::sync::LazyLock;

/// Levels by which a channel may differ, and the part of the pixels in which one may differ by more: the last bits of sines and
/// exponentials are those of the system's library.
const SAME_LEVELS: u8 = 8;
const DIFFERENT_PIXELS: f64 = 0.001;

/// The largest mean error by FLIP, which weighs what an observer sees.
const FLIP: f32 = 0.001;

/// A person among bodies of all round and flat shapes.
static SCENE: LazyLock<(Scene, Vec<Camera>)> = LazyLock::new(|| {
    let rendered = Rendered::new(Subject::person_at(0.4), 6, (320, 240)).expect("a scene");
    let images: Vec<_> = rendered.images.iter().cloned().map(Some).collect();
    let mut scene = RealCameras::new(&rendered.cameras).scene(&rendered.hull, images).expect("a scene");
    let body = |shape: Shape, place: [f64; 3], colour: [u8; 3]| Drawn {
        shape,
        world_from_body: Isometry3::new(Vector3::from(place), Vector3::new(0.2, 0.3, 0.4)),
        colour,
    };
    scene.bodies = vec![
        body(Shape::cube(0.25), [0.5, -0.3, 0.4], [222, 86, 62]),
        body(Shape::Sphere { radius: 0.15 }, [-0.45, 0.4, 0.6], [66, 118, 202]),
        body(Shape::Capsule { radius: 0.07, length: 0.3 }, [0.5, 0.4, 0.9], [240, 188, 60]),
        body(Shape::Cylinder { radius: 0.12, length: 0.2 }, [-0.5, -0.4, 0.2], [146, 92, 186]),
    ];
    (scene, rendered.cameras)
});

/// Draws with `options` from a viewpoint between the cameras.
fn drawn(renderer: &mut Renderer, options: &DrawOptions) -> Picture {
    let viewpoint = Orbit { elevation: 0.35, ..Orbit::around(SCENE.0.hull.aabb(), 0.6) };
    renderer.draw(&SCENE.0, &viewpoint.camera((240, 180)).expect("a viewpoint"), options).expect("a picture")
}

/// Compares `found` with the golden image of this name, which has to be drawn by the same kind of renderer.
fn check(name: &str, found: &RgbImage) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.png"));
    if std::env::var_os("RECORD_GOLDEN").is_some() {
        found.save(&path).expect("a file to write");
    }
    let expected = image::open(&path).expect("a golden image").into_rgb8();
    assert_eq!(found.dimensions(), expected.dimensions());
    let differs = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > SAME_LEVELS)
    };
    let different = found.pixels().zip(expected.pixels()).filter(|pair| differs(*pair)).count();
    let part = different as f64 / f64::from(found.width() * found.height());
    let flip = flip(found, &expected);
    if part > DIFFERENT_PIXELS || flip > FLIP {
        let actual = std::env::temp_dir().join(format!("{name}.png"));
        found.save(&actual).expect("a file to write");
        panic!("{name}: {part:.4} of the pixels differ, FLIP {flip:.5}; see {}", actual.display());
    }
}

/// The mean error that an observer sees (Andersson et al. 2020).
fn flip(a: &RgbImage, b: &RgbImage) -> f32 {
    let (width, height) = a.dimensions();
    let image = |of: &RgbImage| nv_flip::FlipImageRgb8::with_data(width, height, of.as_raw());
    let errors = nv_flip::flip(image(a), image(b), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    nv_flip::FlipPool::from_image(&errors).mean()
}

#[test]
fn pictures_of_the_processor_are_the_golden_ones() {
    let mut renderer = Renderer::open(RendererKind::Cpu, Method::Blend).expect("a renderer");
    let plain = DrawOptions::default();
    check("cpu_blend", &drawn(&mut renderer, &plain).colour);
    check("cpu_unrefined", &drawn(&mut renderer, &DrawOptions { refine: false, ..plain }).colour);
    check("cpu_hull", &drawn(&mut renderer, &DrawOptions { method: Method::Hull, ..plain }).colour);
    let bare = DrawOptions { shadows: false, surroundings: false, ..plain };
    check("cpu_bare", &drawn(&mut renderer, &bare).colour);
}

#[cfg(feature = "gpu")]
#[test]
fn pictures_of_a_gpu_are_the_golden_ones() {
    let mut renderer =
        Renderer::open(RendererKind::Gpu, Method::Blend).unwrap_or_else(|error| panic!("{error}"));
    let plain = DrawOptions::default();
    for (name, method) in
        [("gpu_blend", Method::Blend), ("gpu_hull", Method::Hull), ("gpu_sweep", Method::Sweep)]
    {
        check(name, &drawn(&mut renderer, &DrawOptions { method, ..plain }).colour);
    }
}

#[cfg(feature = "gpu")]
#[test]
fn a_gpu_and_the_processor_draw_pictures_that_an_observer_cannot_tell_apart() {
    let mut gpu = Renderer::open(RendererKind::Gpu, Method::Blend).unwrap_or_else(|error| panic!("{error}"));
    for method in [Method::Blend, Method::Hull] {
        let options = DrawOptions { method, ..DrawOptions::default() };
        let (a, b) = (drawn(&mut Renderer::Cpu, &options), drawn(&mut gpu, &options));
        // A GPU blends colours of eight bits, and rays that graze the subject may hit or miss.
        let error = flip(&a.colour, &b.colour);
        assert!(error < 0.01, "{method:?}: {error}");
    }
}

#[test]
fn a_picture_from_the_place_of_a_real_camera_shows_its_image() {
    let (scene, cameras) = &*SCENE;
    let mut renderer = Renderer::open(RendererKind::Cpu, Method::Blend).expect("a renderer");
    let picture = renderer.draw(scene, &cameras[1], &DrawOptions::default()).expect("a picture");
    check("cpu_snapped", &picture.colour);

    // Where no body or shadow is in front, it is the image itself.
    let bare = Scene { bodies: Vec::new(), ..scene.clone() };
    let picture = renderer.draw(&bare, &cameras[1], &DrawOptions::default()).expect("a picture");
    assert_eq!(Some(&picture.colour), bare.views[1].photo());
}

#[test]
fn a_picture_is_the_same_each_time() {
    let mut renderer = Renderer::open(RendererKind::Cpu, Method::Blend).expect("a renderer");
    let options = DrawOptions::default();
    assert_eq!(drawn(&mut renderer, &options), drawn(&mut renderer, &options));
}
