//! A thin rod that strikes balls at rest and misses them, and fast balls that strike a rod at rest, in ODE: what passes the
//! hull between two collides, with and without a sweep.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::Motion;
use ode_visual_hull::ode::{BodyId, Shape, Surface, Swept, World};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage};
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::random::Random;

/// Passes of each kind.
const PASSES: usize = 12;

/// Frames a second.
const RATE: f64 = 30.0;

/// The rates of the simulation, in steps a second.
const STEP_RATES: [f64; 2] = [120.0, 240.0];

/// The radius of the rod, and its length without its round ends.
const ROD: (f64, f64) = (0.025, 0.6);

/// The distance of what moves from what rests, at the start and at the end, in metres.
const WAY: f64 = 0.7;

/// The speed of the fast balls, in m/s.
const FAST: f64 = 40.0;

/// How the hull is collided.
#[derive(Debug, Clone, Copy)]
struct Way {
    motion: Motion,
    swept: Swept,
    step: f64,
}

/// A pass of a rod and a ball, one of which rests at the origin.
#[derive(Debug, Clone, Copy)]
struct Pass {
    /// The radius of the ball.
    radius: f64,
    speed: f64,
    /// The direction of what moves, in the plane of the floor.
    azimuth: f64,
    /// The distance of its way from the origin.
    aside: f64,
    /// When the two are nearest, in frames after a frame.
    phase: f64,
}

/// What a simulation has found.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    /// The speed that the ball has gained, in m/s.
    gained: Vector3<f64>,
    /// When the two touched first, in seconds, by the hull's clock.
    touched: Option<f64>,
}

impl Pass {
    /// A pass that strikes.
    fn striking(random: &mut Random, radius: f64, speed: f64) -> Self {
        let azimuth = random.between(0.0, std::f64::consts::TAU);
        let aside = random.between(-0.7, 0.7) * (ROD.0 + radius);
        Self { radius, speed, azimuth, aside, phase: random.unit() }
    }

    /// A pass that misses the rod's hull by 2 to 6 pixels. Seven views bound a cylinder by a prism of 14 sides.
    fn missing(random: &mut Random, radius: f64, speed: f64) -> Self {
        let of_hull = ROD.0 / (std::f64::consts::PI / 14.0).cos();
        let aside = radius + of_hull + pixel() * random.between(2.0, 6.0);
        let aside = if random.unit() < 0.5 { -aside } else { aside };
        Self { aside, ..Self::striking(random, radius, speed) }
    }

    /// When the two are nearest, after at least five frames.
    fn nearest(&self) -> f64 {
        ((WAY / self.speed * RATE).ceil().max(5.0) + self.phase) / RATE
    }

    /// When they touch.
    fn touches(&self) -> f64 {
        let before = ((ROD.0 + self.radius).powi(2) - self.aside.powi(2)).max(0.0).sqrt();
        self.nearest() - before / self.speed
    }

    /// The unit direction of the motion.
    fn direction(&self) -> Vector3<f64> {
        Vector3::new(self.azimuth.cos(), self.azimuth.sin(), 0.0)
    }

    /// The place of what moves.
    fn place(&self, time: f64) -> Isometry3<f64> {
        let direction = self.direction();
        let along = (self.speed * (time - self.nearest())).clamp(-WAY, WAY);
        let place = direction * along + Vector3::z().cross(&direction) * self.aside;
        at(place.x, place.y, place.z)
    }

    /// The speed at which the two approach along the normal where they touch.
    fn approach(&self) -> f64 {
        self.speed * (1.0 - (self.aside / (ROD.0 + self.radius)).powi(2)).max(0.0).sqrt()
    }

    fn end(&self) -> f64 {
        self.nearest() + 0.4 / self.speed + 2.0 / RATE
    }

    /// The masks of the rod that moves.
    fn film(&self, cameras: &[Camera]) -> Vec<Vec<GrayImage>> {
        let end = (self.end() * RATE) as usize + 2;
        (0..=end).map(|k| masks(cameras, &rod(&self.place(k as f64 / RATE)), coverage)).collect()
    }

    /// The rod of `film` passes a ball at rest.
    fn of_rod(&self, cameras: &[Camera], film: &[Vec<GrayImage>], way: &Way) -> Outcome {
        let ball = at(0.0, 0.0, 0.0);
        simulate(cameras, film, way, self.end(), |world| {
            add_body(world, &Shape::Sphere { radius: self.radius }, &ball).0
        })
    }

    /// A ball passes a rod at rest.
    fn of_ball(&self, cameras: &[Camera], film: &[Vec<GrayImage>], way: &Way) -> Outcome {
        // The ball starts when the hull has a motion, and a little later each time.
        let start = self.direction() * (-WAY - self.phase * self.speed * way.step)
            + Vector3::z().cross(&self.direction()) * self.aside;
        simulate(cameras, film, way, 0.2 + 2.0 * WAY / self.speed, |world| {
            let pose = at(start.x, start.y, start.z);
            let (body, _) = add_body(world, &Shape::Sphere { radius: self.radius }, &pose);
            world.body_mut(body).set_linear_velocity(&(self.direction() * self.speed)).expect("finite");
            body
        })
    }

    /// Whether the ball has gained at least half the speed of the approach.
    fn is_hit(&self, outcome: &Outcome) -> bool {
        outcome.gained.norm() >= 0.5 * self.approach()
    }
}

fn rod(pose: &Isometry3<f64>) -> Subject {
    let solid = Solid::capsule(ROD.0, ROD.1).expect("a capsule");
    Subject::new(vec![Placed::new(solid, *pose, Texture::plain([200; 3]))])
}

/// Simulates the masks of `film` and the ball that `add_ball` adds, without gravity and friction, up to the time `end`.
fn simulate(
    cameras: &[Camera],
    film: &[Vec<GrayImage>],
    way: &Way,
    end: f64,
    add_ball: impl FnOnce(&mut World) -> BodyId,
) -> Outcome {
    let data = data(cameras);
    let mut world = world(0, 0.001);
    world.set_gravity(&Vector3::zeros()).expect("finite");
    world.set_erp(0.05).expect("in range");
    let root = world.root_space();
    let hull = world.add_hull(root, &data).expect("room for the class");
    world.hull_mut(hull).set_motion(way.motion);
    world.hull_mut(hull).set_swept(way.swept);
    let ball = add_ball(&mut world);
    let before: Vector3<f64> = world.body(ball).linear_velocity();

    let (mut frame, mut touched) = (0, None);
    for k in 0..(end / way.step) as usize {
        let time = k as f64 * way.step;
        while frame as f64 / RATE <= time + 1e-9 && frame < film.len() {
            publish(&data, &film[frame], frame as f64 / RATE);
            frame += 1;
        }
        world.hull_mut(hull).set_time(time).expect("times that grow");
        if touched.is_none() {
            let shown = world.hull(hull).frame().expect("a frame").time();
            world
                .collide(|pair| {
                    let first = pair.contacts(8).iter().map(|contact| contact.time).reduce(f64::min);
                    touched = first.map(|first| shown + first);
                })
                .expect("pairs that ODE collides");
        }
        world.default_collide(&Surface::with_friction(0.0), 8).expect("a valid surface");
        world.quick_step(way.step).expect("finite states");
    }
    let after: Vector3<f64> = world.body(ball).linear_velocity();
    Outcome { gained: after - before, touched }
}

/// Passes of one ball at one speed, with their masks.
struct Strikes<'c> {
    cameras: &'c [Camera],
    passes: Vec<(Pass, Vec<Vec<GrayImage>>)>,
}

impl<'c> Strikes<'c> {
    fn new(cameras: &'c [Camera], radius: f64, speed: f64) -> Self {
        let mut random = Random(1);
        let pass = |_| Pass::striking(&mut random, radius, speed);
        let passes = (0..PASSES).map(pass).map(|pass| (pass, pass.film(cameras))).collect();
        Self { cameras, passes }
    }

    fn outcomes(&self, motion: Motion, swept: Swept) -> Vec<(&Pass, f64, Outcome)> {
        let of = |rate: f64| {
            let way = Way { motion, swept, step: 1.0 / rate };
            self.passes
                .iter()
                .map(move |(pass, film)| (pass, way.step, pass.of_rod(self.cameras, film, &way)))
        };
        STEP_RATES.into_iter().flat_map(of).collect()
    }
}

/// The part of the passes that hit.
fn hit_rate(outcomes: &[(&Pass, f64, Outcome)]) -> f64 {
    outcomes.iter().filter(|(pass, _, outcome)| pass.is_hit(outcome)).count() as f64 / outcomes.len() as f64
}

/// The largest error of the time of impact, over 2 ms or the time in which the rod moves by 3 mm.
fn time_error(outcomes: &[(&Pass, f64, Outcome)]) -> f64 {
    let error = |(pass, _, outcome): &(&Pass, f64, Outcome)| {
        let error = outcome.touched.map_or(f64::INFINITY, |touched| (touched - pass.touches()).abs());
        error / (0.003 / pass.speed).max(0.002)
    };
    outcomes.iter().map(error).fold(0.0, f64::max)
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let cameras = level_ring(0.0);
    let (mut reported, mut worst_rate, mut worst_error) = (Vec::new(), 1.0_f64, 0.0_f64);
    for (ball, radius, bounded_to) in [("10_cm", 0.05, 5.0), ("4_cm", 0.02, 4.0)] {
        for speed in [1.0, 2.0, 3.0, 4.0, 5.0] {
            progress(&format!("a rod at {speed} m/s strikes a ball of {ball}"));
            let strikes = Strikes::new(&cameras, radius, speed);
            let swept = strikes.outcomes(Motion::Interpolated, Swept::On);
            let (rate, error) = (hit_rate(&swept), time_error(&swept));
            if speed <= bounded_to {
                worst_rate = worst_rate.min(rate);
            }
            worst_error = worst_error.max(error);
            let mut report = |name: &str, value| {
                reported.push(Figure::reported(&format!("{name}_{ball}_{speed}_m_s"), value));
            };
            report("tunnel_hit_rate", rate);
            report("impact_time_error_over_bound", error);
            report("tunnel_hit_rate_unswept", hit_rate(&strikes.outcomes(Motion::Interpolated, Swept::Off)));
            report("tunnel_hit_rate_held", hit_rate(&strikes.outcomes(Motion::Held, Swept::Off)));
        }
    }

    let mut figures = vec![
        Figure::bounded("tunnel_hit_rate", worst_rate, Bound::AtLeast(1.0)),
        Figure::bounded("impact_time_error_over_bound", worst_error, Bound::AtMost(1.0)),
        Figure::bounded("tunnel_false_hits", false_hits(&cameras, progress), Bound::AtMost(0.0)),
        Figure::bounded(
            "tunnel_hit_rate_fast_ball",
            fast_balls(&cameras, Swept::On, progress),
            Bound::AtLeast(1.0),
        ),
        Figure::reported("tunnel_hit_rate_fast_ball_unswept", fast_balls(&cameras, Swept::Off, progress)),
    ];
    figures.extend(reported);
    figures
}

/// How many balls a swept rod has moved that it misses.
fn false_hits(cameras: &[Camera], progress: &dyn Fn(&str)) -> f64 {
    let mut random = Random(2);
    let mut hits = 0;
    for (radius, speed) in [(0.05, 2.0), (0.05, 5.0), (0.02, 2.0), (0.02, 5.0)] {
        progress(&format!("a rod at {speed} m/s misses a ball of radius {radius} m"));
        for _ in 0..PASSES {
            let pass = Pass::missing(&mut random, radius, speed);
            let film = pass.film(cameras);
            for rate in STEP_RATES {
                let way = Way { motion: Motion::Interpolated, swept: Swept::On, step: 1.0 / rate };
                hits += usize::from(pass.of_rod(cameras, &film, &way).touched.is_some());
            }
        }
    }
    hits as f64
}

/// The part of the fast balls that a rod at rest stops or turns aside.
fn fast_balls(cameras: &[Camera], swept: Swept, progress: &dyn Fn(&str)) -> f64 {
    progress("balls strike a rod at rest");
    let frame = masks(cameras, &rod(&Isometry3::from(Point3::origin())), coverage);
    let film = vec![frame; 20];
    let mut random = Random(3);
    let (mut hits, mut passes) = (0, 0);
    for radius in [0.05, 0.02] {
        for motion in [Motion::Held, Motion::Interpolated] {
            for rate in STEP_RATES {
                for _ in 0..PASSES {
                    let pass = Pass::striking(&mut random, radius, FAST);
                    let way = Way { motion, swept, step: 1.0 / rate };
                    hits += usize::from(pass.is_hit(&pass.of_ball(cameras, &film, &way)));
                    passes += 1;
                }
            }
        }
    }
    hits as f64 / passes as f64
}
