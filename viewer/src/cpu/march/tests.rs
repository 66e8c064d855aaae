use super::*;
use crate::cpu::lanes::LANES;
use ode_visual_hull::camera;
use ode_visual_hull::hull::Hull;
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::rendered::Rendered;

fn person() -> (Rendered, Scene) {
    let rendered = Rendered::new(Subject::person_at(0.4), 6, (320, 240)).unwrap();
    let images: Vec<_> = rendered.images.iter().cloned().map(Some).collect();
    let scene = crate::scene::RealCameras::new(&rendered.cameras).scene(&rendered.hull, images).unwrap();
    (rendered, scene)
}

/// Rays from around the subject towards its box.
fn rays(count: usize) -> impl Iterator<Item = camera::Ray> {
    let mut random = Random(3);
    (0..count).map(move |_| {
        let origin = Point3::new(0.0, 0.0, 0.9) + random.direction() * 2.5;
        let target = random.point(Point3::new(-0.4, -0.4, 0.0), Point3::new(0.4, 0.4, 1.75));
        camera::Ray { origin, direction: (target - origin).normalize() }
    })
}

fn single(ray: &camera::Ray) -> Ray {
    Ray { origin: ray.origin.cast(), direction: ray.direction.cast() }
}

#[test]
fn rays_enter_where_the_exact_ray_cast_says_to_within_two_pixels() {
    let (rendered, scene) = person();
    let march = March::new(&scene);
    let pixel = rendered.hull.pixel_size(&Point3::new(0.0, 0.0, 0.9));
    let mut lines = Lines::default();
    let (mut asked, mut differ) = (0, 0);
    for ray in rays(4000) {
        let exact = rendered.hull.ray_cast(&ray);
        let found = march.entry(&single(&ray), 0.0..f32::MAX, &mut lines);
        let agree = match (exact, found) {
            // An entry at a small angle to the surface moves along it by more than the surface does.
            (Some((Some(exact), _)), Some(found)) => {
                let slope = exact.normal.dot(&ray.direction).abs().max(0.1);
                (f64::from(found.t) - exact.t).abs() < 2.0 * pixel / slope
            }
            (None, None) => continue,
            _ => false,
        };
        asked += 1;
        differ += usize::from(!agree);
    }
    // Rays that only graze a limb: the exact surface is that of coverage, this one that of whole pixels. A limb has 8 pixels.
    assert!(asked > 1000 && differ as f64 <= 0.04 * asked as f64, "{differ} of {asked}");
}

#[test]
fn rays_of_a_packet_enter_where_each_alone_does() {
    let (_, scene) = person();
    let mut abstaining = scene.clone();
    let views = scene.hull.views().to_vec();
    let unseen = Unseen::Abstain { min_views: 2 };
    abstaining.hull = Hull::new(views, *scene.hull.bounds(), unseen, scene.hull.time());
    for scene in [&scene, &abstaining] {
        let march = March::new(scene);
        let (mut lines, mut packets) = (Lines::default(), Packets::default());
        let all: Vec<_> = rays(4000).map(|ray| single(&ray)).collect();
        let (mut hits, mut differ) = (0, 0);
        for rays in all.as_chunks::<LANES>().0 {
            // The last ray never sets out, and the first has to enter nearby.
            let mut ranges = [const { 0.0..f32::MAX }; LANES];
            (ranges[0], ranges[LANES - 1]) = (0.5..2.4, 1.0..0.5);
            let together = march.entries(rays, &ranges, &mut packets);
            assert!(together[LANES - 1].is_none());
            for ((ray, range), together) in rays.iter().zip(ranges).zip(together) {
                let alone = if range.is_empty() { None } else { march.entry(ray, range, &mut lines) };
                hits += usize::from(alone.is_some());
                differ += usize::from(match (alone, together) {
                    (Some(alone), Some(together)) => (alone.t - together.t).abs() > 2e-3,
                    (None, None) => false,
                    _ => true,
                });
            }
        }
        // Views are asked in another order, so that rays which graze a limb leap to other places of it.
        assert!(hits > 1000 && differ as f64 <= 0.01 * hits as f64, "{differ} of {hits}");
    }
}

#[test]
fn no_ray_of_a_cone_enters_before_the_cone_does() {
    let (_, scene) = person();
    let march = March::new(&scene);
    let (mut random, mut lines) = (Random(11), Lines::default());
    let spread = 0.02;
    let mut hits = 0;
    for ray in rays(1500) {
        let axis = single(&ray);
        let cone = march.cone_entry(&axis, spread, &mut lines);
        for _ in 0..8 {
            let off: Vector3<f32> = (random.direction() * f64::from(0.95 * spread) * random.unit()).cast();
            let other = Ray { direction: (axis.direction + off).normalize(), ..axis };
            if let Some(entry) = march.entry(&other, 0.0..f32::MAX, &mut lines) {
                hits += 1;
                assert!(cone.is_some_and(|start| start <= entry.t + 1e-3), "{cone:?}, {entry:?}");
            }
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn the_normal_is_that_of_the_exact_ray_cast_to_within_ten_degrees_for_most_rays() {
    let (rendered, scene) = person();
    let march = March::new(&scene);
    let mut lines = Lines::default();
    let (mut near, mut all) = (0, 0);
    for ray in rays(1500) {
        let found = march.entry(&single(&ray), 0.0..f32::MAX, &mut lines);
        let (Some((Some(exact), _)), Some(found)) = (rendered.hull.ray_cast(&ray), found) else { continue };
        let normal: Vector3<f64> = march.normal(&single(&ray).at(found.t), found.view).cast();
        all += 1;
        near += usize::from(normal.angle(&exact.normal).to_degrees() < 10.0);
    }
    // Where two silhouettes end the hull side by side either may be taken: on ridges, which are everywhere on limbs of a few
    // pixels.
    assert!(near as f64 > 0.8 * all as f64, "{near} of {all}");
}

#[test]
fn rays_from_kilometres_away_and_past_a_camera_end() {
    let (rendered, scene) = person();
    let march = March::new(&scene);
    let (mut lines, mut hits) = (Lines::default(), 0);
    let middle = Point3::new(0.0_f32, 0.0, 0.9);
    let mut random = Random(5);
    for view in rendered.cameras.iter().cycle().take(300) {
        let off = random.direction().cast::<f32>() * 10.0_f32.powf(-6.0 * random.unit() as f32);
        let near: Point3<f32> = view.centre().cast::<f32>() + off;
        for origin in [middle + (near - middle) * 700.0, near - off.normalize() * 1e-3] {
            let ray = Ray { origin, direction: (middle - origin).normalize() };
            hits += usize::from(march.entry(&ray, 0.0..f32::MAX, &mut lines).is_some());
            march.cone_entry(&ray, 0.01, &mut lines);
        }
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn a_ray_through_the_silhouette_of_its_own_camera_is_somewhere_least_outside_the_others() {
    let (rendered, scene) = person();
    let march = March::new(&scene);
    let mut lines = Lines::default();
    let view = &rendered.cameras[0];
    // On rays that enter the hull that place is inside.
    for (u, v) in (60..260).step_by(7).flat_map(|u| (40..220).step_by(9).map(move |v| (u, v))) {
        let ray = single(&view.ray(f64::from(u), f64::from(v)).unwrap());
        if march.entry(&ray, 0.0..f32::MAX, &mut lines).is_none() {
            continue;
        }
        let least = march.least_outside(&ray, 0).unwrap();
        let worst = march.views().iter().skip(1).map(|view| {
            let h = view.homogeneous(&ray.at(least.t));
            view.distance(h.x / h.z, h.y / h.z)
        });
        assert!(worst.fold(f32::MIN, f32::max) < 1.0, "{u}, {v}: {least:?}");
    }
}

#[test]
fn beyond_the_known_distances_none_is_greater_than_the_true_one() {
    let (rendered, scene) = person();
    let march = March::new(&scene);
    let silhouette = rendered.hull.views()[0].silhouette();
    let subject: Vec<(i32, i32)> = silhouette.edge_pixels().collect();
    for (i, j) in (-60..380).step_by(13).flat_map(|i| (-40..280).step_by(11).map(move |j| (i, j))) {
        let squared = subject.iter().map(|(x, y)| ((x - i).pow(2) + (y - j).pow(2)) as f32);
        let nearest = squared.fold(f32::INFINITY, f32::min).sqrt();
        let found = march.views()[0].distance(i as f32 + 0.5, j as f32 + 0.5);
        // Distances are measured to the border of a pixel, half a pixel from its centre.
        assert!(found <= nearest + 0.51, "{i}, {j}: {found} > {nearest}");
    }
}
