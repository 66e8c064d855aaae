//! Which of subject and body is in front, against rays through the solids themselves.

use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture};
use ode_visual_hull_film::Drawn;
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::rendered::Rendered;
use ode_visual_hull_viewer::orbit::Orbit;
use ode_visual_hull_viewer::scene::RealCameras;
use ode_visual_hull_viewer::{Content, DrawOptions, Method, Renderer, RendererKind};

/// Viewpoints, bodies around the subject, and the size of the pictures.
const VIEWPOINTS: usize = 24;
const BODIES: usize = 12;
const SIZE: (u32, u32) = (320, 240);

/// The part of the pixels whose rays meet both the subject and a body that show the one in front.
pub fn measure() -> Result<Vec<Figure>> {
    eprintln!("view: occlusion");
    let mut random = Random(7);
    let rendered = Rendered::new(Subject::person_at(0.4), 8, (640, 480))?;
    let images: Vec<_> = rendered.images.iter().cloned().map(Some).collect();
    let mut scene = RealCameras::new(&rendered.cameras).scene(&rendered.hull, images)?;

    // Bodies stand around the subject, and do not reach into its hull.
    let mut solids = Vec::new();
    while scene.bodies.len() < BODIES {
        let pose = Isometry3::from_parts(
            random.point(Point3::new(-0.9, -0.9, 0.1), Point3::new(0.9, 0.9, 1.8)).into(),
            random.rotation(),
        );
        let radius = random.between(0.06, 0.16);
        let in_ball = |random: &mut Random| {
            Point3::from(pose.translation.vector + random.direction() * (radius * random.unit().cbrt()))
        };
        if (0..400).any(|_| rendered.hull.inside(&in_ball(&mut random))) {
            continue;
        }
        let (shape, solid) = match solids.len() % 3 {
            0 => (Shape::Sphere { radius }, Solid::sphere(radius)?),
            1 => (Shape::cube(1.1 * radius), Solid::cuboid(Vector3::repeat(1.1 * radius))?),
            _ => (
                Shape::Capsule { radius: 0.4 * radius, length: radius },
                Solid::capsule(0.4 * radius, radius)?,
            ),
        };
        solids.push(Placed::new(solid, pose, Texture::plain([0; 3])));
        scene.bodies.push(Drawn { shape, world_from_body: pose, colour: [200, 60, 60] });
    }
    let bodies = Subject::new(solids);

    let mut renderer = Renderer::open(RendererKind::Cpu, Method::Blend)?;
    let (mut right, mut asked) = (0_u64, 0_u64);
    for k in 0..VIEWPOINTS {
        let orbit = Orbit {
            elevation: random.between(-0.1, 0.9),
            ..Orbit::around(scene.hull.aabb(), k as f64 * std::f64::consts::TAU / VIEWPOINTS as f64)
        };
        let camera = orbit.camera(SIZE)?;
        let picture = renderer.draw(&scene, &camera, &DrawOptions::default())?;
        for (index, content) in picture.content.iter().enumerate() {
            let (x, y) = (index as u32 % SIZE.0, index as u32 / SIZE.0);
            let Some(ray) = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5) else { continue };
            let hits = (rendered.scene.subject.first_hit(&ray), bodies.first_hit(&ray));
            let (Some((subject, _)), Some((body, _))) = hits else { continue };
            let expected = if subject.t < body.t { Content::Subject } else { Content::Body };
            asked += 1;
            right += u64::from(*content == expected);
        }
    }
    let share = right as f64 / asked as f64;
    Ok(vec![
        Figure::bounded("view_occlusion_right", share, Bound::AtLeast(0.995)),
        Figure::reported("view_occlusion_pixels", asked as f64),
    ])
}
