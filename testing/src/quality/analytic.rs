//! The visual hull of exact silhouettes, the reference for the hull from pixels.

use super::contour::Contour;
use nalgebra::{Point2, Point3, Vector2, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::synthetic::Placed;
use std::f64::consts::TAU;

/// Step of the search for an exit, in pixels of the finest view: far below any feature of the solids.
const STEP_PX: f64 = 0.25;

/// Distance from an edge of the hull, in pixels, below which no normal is compared: a contact normal's window reaches
/// 6.
const EDGE_PX: f64 = 7.0;

/// The analytic visual hull: a point is inside iff each camera's half-line through it meets the solid.
pub struct AnalyticHull {
    contours: Vec<Contour>,
}

impl AnalyticHull {
    /// The hull of `solid`, which each camera has to see entirely.
    pub fn new(cameras: &[Camera], solid: &Placed) -> Self {
        Self { contours: cameras.iter().map(|camera| Contour::trace(camera, solid)).collect() }
    }

    /// The silhouettes' contours, by view.
    pub fn contours(&self) -> &[Contour] {
        &self.contours
    }

    /// Whether `p` is inside.
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        self.contours.iter().all(|contour| contour.sees(p))
    }

    /// Depth of `p`, a point inside, in pixels of the view in which it is shallowest.
    pub fn depth_px(&self, p: &Point3<f64>) -> f64 {
        let depths = self.contours.iter().map(|contour| -contour.signed_distance_of(p));
        depths.fold(f64::INFINITY, f64::min)
    }

    /// Distance of `p` from the hull, in pixels of the view in which it is farthest outside; 0 inside.
    pub fn stray_px(&self, p: &Point3<f64>) -> f64 {
        let outside = self.contours.iter().filter(|contour| !contour.sees(p));
        outside.map(|contour| contour.signed_distance_of(p)).fold(0.0, f64::max)
    }

    /// Whether `p` projects to within `reach` pixels of some view's contour.
    pub fn near_a_contour(&self, p: &Point3<f64>, reach: f64) -> bool {
        self.contours.iter().any(|contour| contour.is_near(p, reach))
    }

    /// The outward normal of the hull's surface nearest to `p`, a point inside; `None` where it is not smooth.
    pub fn exit_direction(&self, p: &Point3<f64>) -> Option<Vector3<f64>> {
        let metres = |contour: &&Contour| -contour.signed_distance_of(p) * footprint(contour.camera(), p);
        let contour = self.contours.iter().min_by(|a, b| metres(a).total_cmp(&metres(b)))?;
        contour.normal_in_world(&contour.nearest(&contour.project(p)?))
    }

    /// Metres along the half-line from `p`, a point inside, in the unit `direction` to where it first leaves the hull,
    /// to a nanometre; and the index of the view whose silhouette it leaves there.
    pub fn exit(&self, p: &Point3<f64>, direction: &Vector3<f64>) -> (f64, usize) {
        let finest = self.contours.iter().map(|contour| footprint(contour.camera(), p)).fold(1.0, f64::min);
        let at = |t: f64| p + direction * t;
        let step = STEP_PX * finest;

        let (mut inside, mut outside) = (0.0, step);
        while self.contains(&at(outside)) {
            (inside, outside) = (outside, outside + step);
        }

        while outside - inside > 1e-9 {
            let middle = 0.5 * (inside + outside);
            *(if self.contains(&at(middle)) { &mut inside } else { &mut outside }) = middle;
        }

        let view = self.contours.iter().position(|contour| !contour.sees(&at(outside)));
        (outside, view.unwrap_or(0))
    }

    /// Whether the hull's surface has an edge near the contour point `on` of view `view`, at `depth` metres from the
    /// camera.
    ///
    /// In the figures, "away from edges" means that the surface is smooth within 7 px. The surface is a cone from the
    /// camera through the contour. It is smooth if the contour does not bend within 7 px ([`Contour::bends_near`]) and
    /// no other view cuts the cone off: all others have to see the subject at points of the cone on a circle of 7 px.
    pub fn near_edge(&self, view: usize, on: &Point2<f64>, depth: f64) -> bool {
        let contour = &self.contours[view];
        let smooth = |across: Vector2<f64>| {
            let around = (0..8).map(|k| (f64::from(k) * TAU / 8.0).sin_cos());
            let others = || self.contours.iter().enumerate().filter(|(other, _)| *other != view);
            around.into_iter().all(|(sin, cos)| {
                let at = on + Vector2::new(-across.y, across.x) * (EDGE_PX * cos);
                let focal = contour.camera().intrinsics()[(0, 0)];
                let p = contour.camera().unproject(at.x, at.y, depth * (1.0 + EDGE_PX * sin / focal));
                p.is_some_and(|p| others().all(|(_, other)| other.sees(&p)))
            })
        };
        contour.bends_near(on, EDGE_PX) || !contour.normal(on).is_some_and(smooth)
    }
}

/// The size of a pixel at the depth of `p`, in metres.
pub fn footprint(camera: &Camera, p: &Point3<f64>) -> f64 {
    let depth = camera.project(p).map_or(f64::INFINITY, |pixel| pixel.depth);
    let k = camera.intrinsics();
    depth / k[(0, 0)].max(k[(1, 1)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry3, point, vector};
    use ode_visual_hull::synthetic::{Solid, Texture, layout};

    fn sphere_hull() -> AnalyticHull {
        let cameras = layout::hemisphere(5, 2.75, Point3::origin(), (160, 120), 0.5).unwrap();
        let sphere = Solid::sphere(0.25).unwrap();
        AnalyticHull::new(&cameras, &Placed::new(sphere, Isometry3::identity(), Texture::plain([200; 3])))
    }

    /// Whether `p` lies in the cone from `camera` around the sphere.
    fn in_cone(camera: &Camera, p: &Point3<f64>) -> bool {
        let (axis, eye) = (-camera.centre().coords, camera.centre());
        (p - eye).angle(&axis) <= (0.25 / axis.norm()).asin()
    }

    #[test]
    fn the_hull_of_a_sphere_is_where_the_cones_meet() {
        let hull = sphere_hull();
        for k in 0..1000 {
            let p = point![f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)] / 15.0;
            let cones = hull.contours().iter().all(|contour| in_cone(contour.camera(), &p));
            assert_eq!(hull.contains(&p), cones, "{p}");
        }
    }

    #[test]
    fn an_exit_lies_on_the_silhouette_of_the_returned_view() {
        let hull = sphere_hull();
        for direction in [vector![0.3, -0.5, 0.1], vector![-0.2, 0.1, 0.9], vector![0.0, 0.8, -0.6]] {
            let direction = direction.normalize();
            let (t, view) = hull.exit(&point![0.02, -0.04, 0.1], &direction);
            let at = |t: f64| point![0.02, -0.04, 0.1] + direction * t;
            assert!(hull.contains(&at(t - 1e-8)) && !hull.contains(&at(t + 1e-8)));
            assert!(!hull.contours()[view].sees(&at(t + 1e-8)));
            assert!(hull.depth_px(&at(t - 1e-8)) < 1e-5 && hull.stray_px(&at(t + 1e-8)) < 1e-5);
        }
    }

    #[test]
    fn the_exit_direction_is_square_to_the_nearest_cone() {
        let hull = sphere_hull();
        let p = hull.contours()[0].camera().centre() * 0.08;
        let direction = hull.exit_direction(&p).unwrap();
        let camera = hull.contours()[hull.exit(&p, &direction).1].camera();
        // A plane through the camera that touches the sphere has its centre 0.25 m behind.
        assert!(((camera.centre().coords).dot(&direction) - 0.25).abs() < 1e-4);
    }
}
