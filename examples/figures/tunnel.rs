//! Thin rods that strike balls, and miss them.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::ode::{Shape, Surface};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage};
use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::random::Random;

/// Passes of each kind.
const PASSES: usize = 12;

/// Frames a second.
const RATE: f64 = 30.0;

/// The radius of the rod, and its length without its round ends.
const ROD: (f64, f64) = (0.025, 0.6);

/// The rod's distance from the ball's centre at the start and at the end, in metres.
const WAY: f64 = 0.7;

/// A rod that passes a ball at rest at the origin.
#[derive(Debug, Clone, Copy)]
struct Pass {
    /// The radius of the ball.
    radius: f64,
    speed: f64,
    /// The direction of the rod's motion, in the plane of the floor.
    azimuth: f64,
    /// The distance of the rod's way from the ball's centre.
    aside: f64,
    /// When the rod is nearest to the ball's centre, in frames after a frame.
    phase: f64,
}

impl Pass {
    fn random(random: &mut Random, radius: f64, speed: f64) -> Self {
        let azimuth = random.between(0.0, std::f64::consts::TAU);
        let aside = random.between(-0.7, 0.7) * (ROD.0 + radius);
        Self { radius, speed, azimuth, aside, phase: random.unit() }
    }

    /// When the rod is nearest to the ball's centre.
    fn nearest(&self) -> f64 {
        ((WAY / self.speed * RATE).ceil().max(5.0) + self.phase) / RATE
    }

    /// The unit direction of the motion.
    fn direction(&self) -> Vector3<f64> {
        Vector3::new(self.azimuth.cos(), self.azimuth.sin(), 0.0)
    }

    /// The place of the rod's axis.
    fn rod(&self, time: f64) -> Isometry3<f64> {
        let direction = self.direction();
        let along = (self.speed * (time - self.nearest())).clamp(-WAY, WAY);
        let place = direction * along + Vector3::z().cross(&direction) * self.aside;
        at(place.x, place.y, place.z)
    }

    fn masks(&self, cameras: &[Camera], time: f64) -> Vec<GrayImage> {
        let solid = Solid::capsule(ROD.0, ROD.1).expect("a capsule");
        let rod = Placed::new(solid, self.rod(time), Texture::plain([200; 3]));
        masks(cameras, &Subject::new(vec![rod]), coverage)
    }

    /// The cosine of the angle between the motion and the normal of the touch.
    fn cosine(&self) -> f64 {
        (1.0 - (self.aside / (ROD.0 + self.radius)).powi(2)).max(0.0).sqrt()
    }

    /// The ball's velocity along the rod's after the pass, over the analytic speed.
    fn film(&self, cameras: &[Camera]) -> Vec<Vec<GrayImage>> {
        let end = ((self.nearest() + 0.4 / self.speed) * RATE) as usize + 4;
        (0..=end).map(|k| self.masks(cameras, k as f64 / RATE)).collect()
    }

    fn simulate(&self, cameras: &[Camera], film: &[Vec<GrayImage>], motion: Motion, rate: f64) -> f64 {
        let data = data(cameras);
        let mut world = world(0, 0.001);
        world.set_gravity(&Vector3::zeros()).expect("finite");
        world.set_erp(0.05).expect("in range");
        let root = world.root_space();
        let hull = world.add_hull(root, &data).expect("room for the class");
        world.hull_mut(hull).set_motion(motion);
        let (body, _) = add_body(&mut world, &Shape::Sphere { radius: self.radius }, &at(0.0, 0.0, 0.0));

        let step = 1.0 / rate;
        let end = self.nearest() + 0.4 / self.speed + 2.0 / RATE;
        let mut frame = 0;
        let mut k = 0;
        while (k as f64) * step < end {
            let time = k as f64 * step;
            while frame as f64 / RATE <= time + 1e-9 {
                publish(&data, &film[frame], frame as f64 / RATE);
                frame += 1;
            }
            world.hull_mut(hull).set_time(time).expect("times that grow");
            world.default_collide(&Surface::with_friction(0.0), 8).expect("a valid surface");
            world.quick_step(step).expect("finite states");
            k += 1;
        }
        world.body(body).linear_velocity().norm() / (self.speed * self.cosine())
    }
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let cameras = level_ring(0.0);
    let mut figures = Vec::new();
    for (ball, radius) in [("10_cm", 0.05), ("4_cm", 0.02)] {
        for speed in [1.0, 2.0, 3.0, 4.0, 5.0] {
            progress(&format!("a rod at {speed} m/s strikes a ball of {ball}"));
            let mut random = Random(1);
            let passes: Vec<Pass> = (0..PASSES).map(|_| Pass::random(&mut random, radius, speed)).collect();
            let films: Vec<_> = passes.iter().map(|pass| pass.film(&cameras)).collect();
            for (name, motion) in [("held", Motion::Held), ("interpolated", Motion::Interpolated)] {
                for rate in [120.0, 240.0] {
                    let ratio = |(pass, film): (&Pass, &Vec<_>)| pass.simulate(&cameras, film, motion, rate);
                    let hits = passes.iter().zip(&films).map(ratio).filter(|ratio| *ratio >= 0.5).count();
                    let name = format!("unswept_hit_rate_{name}_{rate}_hz_{ball}_{speed}_m_s");
                    figures.push(Figure::reported(&name, hits as f64 / PASSES as f64));
                }
            }
        }
    }
    figures
}
