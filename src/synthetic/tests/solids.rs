use super::*;

/// The first of `count` equal steps along the ray at which `placed` contains the point: slow, and independent of hits.
fn first_inside(placed: &Placed, ray: &Ray, length: f64, count: u32) -> Option<f64> {
    (0..count).map(|i| length * f64::from(i) / f64::from(count)).find(|&t| placed.contains(&ray.at(t)))
}

#[test]
fn hits_are_where_sampling_along_the_ray_first_finds_the_inside() {
    let mut random = Random::new(1);
    let (length, count) = (6.0, 3000);
    for solid in each_solid() {
        let mut hits = 0;
        for _ in 0..150 {
            let placed = Placed::new(solid, pose(&mut random, Vector3::zeros()), Texture::plain([0; 3]));
            let origin = Point3::from(direction(&mut random) * 3.0);
            let aim = placed.centre() + direction(&mut random) * 0.4 * random.even();
            let ray = Ray { origin, direction: (aim - origin).normalize() };
            let sampled = first_inside(&placed, &ray, length, count);
            let Some(hit) = placed.first_hit(&ray) else {
                assert_eq!(sampled, None, "{solid:?}: sampling finds an inside without a hit");
                continue;
            };
            hits += 1;

            // Sampling may step over a short chord, but never finds the inside earlier.
            assert!(sampled.is_none_or(|t| t >= hit.t - 1e-9), "{solid:?}: inside before the hit");

            let slope = -hit.normal.dot(&ray.direction);
            assert!(slope > -1e-6 && (hit.normal.norm() - 1.0).abs() < 1e-12);
            if slope > 0.1 {
                assert!(!placed.contains(&ray.at(hit.t - 1e-9)) && placed.contains(&ray.at(hit.t + 1e-9)));
            }
        }

        assert!(hits > 40, "{solid:?}: only {hits} hits");
    }
}

#[test]
fn normals_are_perpendicular_to_the_surface() {
    let mut random = Random::new(2);
    for solid in each_solid() {
        for _ in 0..60 {
            let inside = match solid {
                Solid::Torus { major, .. } => Point3::new(0.0, major, 0.0),
                _ => Point3::origin(),
            };
            let ray = Ray { origin: inside, direction: direction(&mut random) };
            let hit = solid.first_hit(&ray).expect("a ray from inside leaves");
            assert!(hit.normal.dot(&ray.direction) > 0.0, "{solid:?}: a ray leaves along the normal");

            let side = hit.normal.cross(&direction(&mut random)).normalize() * 1e-4;
            // Surfaces of radius 0.1 m or more leave their tangent plane by at most 5e-8 m at a distance of 1e-4 m.
            let beside = ray.at(hit.t) + side;
            assert!(!solid.contains(&(beside + hit.normal * 1e-7)), "{solid:?}");
            assert!(solid.contains(&(beside - hit.normal * 1e-7)), "{solid:?}");
        }
    }
}

/// Points of the surface whose tangent plane has the whole solid on one side, with their normals.
fn supporting_points(solid: &Solid, random: &mut Random) -> Vec<(Point3<f64>, Vector3<f64>)> {
    let mut points = Vec::new();
    for _ in 0..40 {
        let out = direction(random);
        points.push(match *solid {
            Solid::Sphere { radius } => (Point3::from(out * radius), out),
            Solid::Cuboid { lengths } => {
                let face = Vector3::x() * out.x.signum();
                let across = Vector3::new(0.0, out.y * 0.4 * lengths.y, out.z * 0.4 * lengths.z);
                (Point3::from(face * (0.5 * lengths.x) + across), face)
            }
            Solid::Capsule { radius, length } => {
                let radial = Vector3::new(out.x, out.y, 0.0).normalize();
                let along = Vector3::z() * (out.z * 0.5 * length);
                (Point3::from(radial * radius + along), radial)
            }
            Solid::Torus { major, minor } => {
                let radial = Vector3::new(out.x, out.y, 0.0).normalize();
                let normal = (radial * random.even() + Vector3::z() * out.z).normalize();
                (Point3::from(radial * major + normal * minor), normal)
            }
        });
    }
    points
}

#[test]
fn grazing_and_missing_rays_are_distinguished_to_a_nanometre() {
    let mut random = Random::new(3);
    for solid in each_solid() {
        for (point, normal) in supporting_points(&solid, &mut random) {
            let placed =
                Placed::new(solid, pose(&mut random, Vector3::new(0.0, 0.0, 1.0)), Texture::plain([0; 3]));
            let along = normal.cross(&direction(&mut random)).normalize();

            let at_height = |height: f64| Ray {
                origin: placed.world_from_solid() * (point + normal * height - along * 5.0),
                direction: placed.world_from_solid() * along,
            };

            assert!(!placed.is_hit(&at_height(1e-9)), "{solid:?}: a ray 1 nm outside hits");
            assert!(placed.is_hit(&at_height(-1e-9)), "{solid:?}: a ray 1 nm inside misses");
        }
    }
}

#[test]
fn rays_that_graze_the_hole_of_a_torus_hit_or_miss_by_their_distance() {
    // The independent reference is the distance of a ray from the tube's circle, minimised by brute force.
    let (major, minor) = (0.3, 0.1);
    let torus = Solid::torus(major, minor).unwrap();
    let mut random = Random::new(4);
    for _ in 0..30 {
        let tilt = direction(&mut random) * 0.5 + Vector3::z();
        let mut ray = Ray { origin: Point3::from(-tilt * 3.0), direction: tilt.normalize() };

        let distance = |ray: &Ray, t: f64| {
            let p = ray.at(t);
            (p.x.hypot(p.y) - major).hypot(p.z) - minor
        };

        let clearance = |ray: &Ray| {
            let coarse = (0..4000).map(|i| f64::from(i) * 1.5e-3);
            let near = coarse.min_by(|&a, &b| distance(ray, a).total_cmp(&distance(ray, b))).unwrap();
            let (mut from, mut to) = (near - 2e-3, near + 2e-3);
            for _ in 0..80 {
                let (a, b) = (from + (to - from) * 0.4, from + (to - from) * 0.6);
                if distance(ray, a) < distance(ray, b) { to = b } else { from = a }
            }
            distance(ray, 0.5 * (from + to))
        };

        // Move the ray sideways until it just grazes.
        let side = ray.direction.cross(&direction(&mut random)).normalize();
        let start = ray.origin;
        let (mut clear, mut blocked) = (0.0, 0.3);
        assert!(clearance(&ray) > 0.0);
        for _ in 0..45 {
            let middle = 0.5 * (clear + blocked);
            ray.origin = start + side * middle;
            if clearance(&ray) > 0.0 { clear = middle } else { blocked = middle }
        }

        ray.origin = start + side * (clear - 1e-8);
        assert!(!torus.first_hit(&ray).is_some_and(|hit| hit.t < 6.0), "passes by 10 nm");
        ray.origin = start + side * (clear + 1e-8);
        assert!(torus.first_hit(&ray).is_some(), "hits by 10 nm");
    }
}

#[test]
fn rays_along_axes_and_through_centres_hit() {
    let axis = |origin: [f64; 3], direction: Vector3<f64>| Ray { origin: origin.into(), direction };
    let capsule = Solid::capsule(0.1, 0.4).unwrap();
    let along = capsule.first_hit(&axis([0.0, 0.05, -3.0], Vector3::z())).unwrap();
    assert!((along.t - (3.0 - 0.2 - (0.01f64 - 0.0025).sqrt())).abs() < 1e-12);

    // Nearly along the axis, the tube's own crossing is kilometres away and must not affect the caps'.
    let tilted = Vector3::new(0.0, 1e-9, 1.0).normalize();
    assert!((capsule.first_hit(&axis([0.0, 0.05, -3.0], tilted)).unwrap().t - along.t).abs() < 1e-8);

    let torus = Solid::torus(0.3, 0.1).unwrap();
    assert!((torus.first_hit(&axis([-2.0, 0.0, 0.0], Vector3::x())).unwrap().t - 1.6).abs() < 1e-12);
    assert!((torus.first_hit(&axis([0.0, 0.0, 0.0], Vector3::x())).unwrap().t - 0.2).abs() < 1e-12);
    assert_eq!(torus.first_hit(&axis([0.0, 0.0, -2.0], Vector3::z())), None);

    let cuboid = Solid::cuboid(Vector3::new(2.0, 2.0, 2.0)).unwrap();
    assert_eq!(cuboid.first_hit(&axis([-3.0, 0.0, 0.0], Vector3::x())).unwrap().t, 2.0);
    assert_eq!(cuboid.first_hit(&axis([3.0, 0.0, 0.0], Vector3::x())), None, "behind the origin");
}

#[test]
fn impossible_sizes_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Solid::sphere(bad).is_err());
        assert!(Solid::cuboid(Vector3::new(1.0, bad, 1.0)).is_err());
        assert!(Solid::capsule(bad, 1.0).is_err() && Solid::capsule(1.0, bad).is_err());
        assert!(Solid::torus(bad, 0.1).is_err() && Solid::torus(1.0, bad).is_err());
        assert!(Room::new(Vector3::new(1.0, 1.0, bad)).is_err());
    }
    let error = Solid::torus(0.1, 0.2).unwrap_err().to_string();
    assert_eq!(error, "expected a torus's minor radius below its major one, found 0.2 and 0.1 m");
}

#[test]
fn a_solid_without_a_finite_pose_is_invisible() {
    let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
    let subject = heap(Vector3::zeros()).transformed(&nan);
    let mask = silhouette(&distorting_camera(), &subject);
    assert!(mask.iter().all(|&value| value == 0) && !subject.contains(&Point3::origin()));
    assert!(coverage(&distorting_camera(), &subject).iter().all(|&value| value == 0));
}
