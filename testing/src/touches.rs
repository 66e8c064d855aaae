//! Scripted touches: bodies that are moved against the separate balls of a hull and away again, while masks are noisy and
//! flicker, so that it is known which contact events there have to be.

use crate::edge_noise::displace_edge;
use crate::mask_errors::{bitten, speckled};
use crate::random::Random;
use crate::scene::publish;
use image::{GrayImage, Luma};
use nalgebra::{Isometry3, Point2, Point3, Vector3, point, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData, Motion};
use ode_visual_hull::ode::{Amount, BodyId, GeomId, HullEvent, HullEventKind, Mass, Ode, Shape, World};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use std::collections::HashMap;
use std::sync::Arc;

/// Frames a second.
pub const RATE: f64 = 30.0;

/// Steps of the simulation in a frame.
pub const STEPS: usize = 2;

/// Seconds of a step.
pub const STEP: f64 = 1.0 / (RATE * STEPS as f64);

/// The radius of the subject's balls, in metres.
pub const BALL: f64 = 0.15;

/// The radius of the bodies, which are balls too.
pub const BODY: f64 = 0.03;

/// The subject's balls turn about the z axis at this distance, in metres. Their centres are 0.95 m from one another, and they
/// pass one another in each image.
const AXIS_DISTANCE: f64 = 0.55;

/// The frames of a turn: twelve seconds.
const TURN: usize = 360;

/// The distance of the centres of a body and a ball while they touch, and while they do not, in metres: the body's surface
/// is 46 mm inside the ball, which is 4 pixels and so four standard deviations of the masks' noise, and 90 mm outside, of
/// which the hull of six views takes 24 mm.
const TOUCHING: f64 = BALL + BODY - 0.046;
const APART: f64 = BALL + BODY + 0.09;

/// The default wait of events, in seconds.
pub const WAIT: f64 = 0.1;

/// The part of the frames in which a view begins to flicker.
const FLICKER: f64 = 0.25;

/// The largest number of frames for which a view flickers, so that a touch has no contact for less than 0.1 s.
const LONGEST_FLICKER: usize = 2;

/// How often contacts were as the script says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Scripted touches.
    pub touches: usize,
    /// Beginnings and ends that are missing.
    pub missed: usize,
    /// Beginnings and ends too many.
    pub doubled: usize,
    /// Events of another part of the hull.
    pub misplaced: usize,
}

/// The centre of a ball of the subject at a time.
pub fn centre(ball: usize, time: f64) -> Point3<f64> {
    let angle = std::f64::consts::TAU * (ball as f64 / 3.0 + time * RATE / TURN as f64);
    point![AXIS_DISTANCE * angle.cos(), AXIS_DISTANCE * angle.sin(), 0.12 * (ball as f64 - 1.0)]
}

/// Six cameras around the subject; a pixel is 12 mm there.
pub fn cameras() -> Vec<Camera> {
    layout::staggered(6, 3.0, &[0.1, 1.2], Point3::origin(), (160, 120), 0.65).unwrap()
}

/// Masks of the three balls at a time, without noise.
pub fn clean_masks(cameras: &[Camera], time: f64) -> Vec<GrayImage> {
    let ball = |k: usize| {
        let place = Isometry3::from(centre(k, time).coords);
        Placed::new(Solid::sphere(BALL).unwrap(), place, Texture::plain([200; 3]))
    };
    let subject = Subject::new((0..3).map(ball).collect());
    cameras.iter().map(|camera| coverage(camera, &subject)).collect()
}

/// A world without gravity with a hull that records events, and its data.
pub fn world_with_events(cameras: &[Camera], motion: Motion) -> (World, GeomId, Arc<HullData>) {
    let data = Arc::new(HullData::new());
    data.add_views(cameras).unwrap();
    let half = vector![1.0, 1.0, 0.6];
    data.set_bounds(Aabb::new(Point3::origin() - half, Point3::origin() + half).unwrap()).unwrap();

    let mut world = World::new(&Ode::init().unwrap()).unwrap();
    let root = world.root_space();
    let hull = world.add_hull(root, &data).unwrap();
    world.hull_mut(hull).set_motion(motion);
    world.hull_mut(hull).set_events(true);
    (world, hull, data)
}

/// Adds a body, a ball that collides with hulls alone.
pub fn add_ball(world: &mut World) -> BodyId {
    let (shape, root) = (Shape::Sphere { radius: BODY }, world.root_space());
    let (body, geom) = (world.add_body(), world.add_geom(root, &shape).unwrap());
    world.geom_mut(geom).set_body(Some(body)).unwrap();
    world.geom_mut(geom).set_category_bits(2);
    world.geom_mut(geom).set_collide_bits(1);
    world.body_mut(body).set_mass(&Mass::of(&shape, Amount::Total(0.1)).unwrap()).unwrap();
    body
}

/// Collides without attaching contacts, and returns the events of the step. Bodies move by their velocities.
pub fn step(world: &mut World, hull: GeomId, time: f64) -> Vec<HullEvent> {
    world.hull_mut(hull).set_time(time).unwrap();
    world.collide(|pair| drop(pair.contacts(8))).unwrap();
    let events = world.hull_mut(hull).events().unwrap().collect();
    world.quick_step(STEP).unwrap();
    events
}

/// Plays touches until there were `touches` of them, with a hull in `motion` whose events wait for `wait` seconds.
pub fn play(touches: usize, motion: Motion, wait: f64, seed: u64) -> Count {
    let cameras = cameras();
    let (mut world, hull, data) = world_with_events(&cameras, motion);
    world.hull_mut(hull).set_event_wait(wait).unwrap();
    // The hull of a moving subject is a frame late.
    let delay = if motion == Motion::Interpolated { 1.0 / RATE } else { 0.0 };
    let (mut random, mut flicker) = (Random(seed), Flicker::default());
    // Rendering takes longer than all else.
    let mut turn: Vec<Vec<GrayImage>> = Vec::new();
    let mut actors: Vec<Actor> =
        (0..48).map(|k| Actor::new(add_ball(&mut world), k % 3, &mut random)).collect();
    let actor_of: HashMap<BodyId, usize> =
        actors.iter().enumerate().map(|(k, actor)| (actor.body, k)).collect();

    let (mut count, mut part_of) = (Count::default(), [None; 3]);
    for frame in 0.. {
        let time = frame as f64 / RATE;
        if frame < TURN {
            turn.push(clean_masks(&cameras, time));
        }
        publish(&data, &flicker.masks(&turn[frame % TURN], frame, &mut random), time);
        for k in 0..STEPS {
            let now = time + k as f64 * STEP;
            for actor in &mut actors {
                actor.act(&mut world, now, delay, count.touches < touches, &mut random, &mut count);
            }
            for event in step(&mut world, hull, now) {
                let actor = &mut actors[actor_of[&event.body.unwrap()]];
                let part = *part_of[actor.ball].get_or_insert(event.part);
                let is_shared = (0..3).any(|ball| ball != actor.ball && part_of[ball] == Some(event.part));
                count.misplaced += usize::from(event.part != part || is_shared);
                match event.kind {
                    HullEventKind::Begin => actor.begun += 1,
                    HullEventKind::End => actor.ended += 1,
                }
            }
        }
        if count.touches >= touches && actors.iter().all(|actor| actor.is_done) {
            return count;
        }
    }
    unreachable!("the script ends")
}

/// A body that is moved against a ball of the subject and away again.
struct Actor {
    body: BodyId,
    ball: usize,
    /// The direction from the ball's centre to the body.
    direction: Vector3<f64>,
    /// When it leaves its place to touch, when it touches, when it leaves, and when it is away and all is over, in seconds.
    times: [f64; 4],
    /// Events of the present touch.
    begun: usize,
    ended: usize,
    is_done: bool,
}

impl Actor {
    fn new(body: BodyId, ball: usize, random: &mut Random) -> Self {
        let start = 0.2 + random.between(0.0, 0.6);
        let mut actor =
            Self { body, ball, direction: Vector3::x(), times: [0.0; 4], begun: 0, ended: 0, is_done: false };
        actor.plan(start, random);
        actor
    }

    /// Plans a touch that begins after `start`.
    fn plan(&mut self, start: f64, random: &mut Random) {
        // Bodies of one ball are beside it, where no other ball is near.
        let outwards = centre(self.ball, start) - Point3::origin();
        self.direction = loop {
            let direction = random.direction();
            if direction.dot(&outwards) > 0.0 {
                break direction;
            }
        };
        let mut time = start;
        let spans = [0.0, random.between(0.04, 0.1), random.between(0.2, 0.3), random.between(0.04, 0.1)];
        self.times = spans.map(|span| {
            time += span;
            time
        });
    }

    /// Moves the body to its place at `now`; counts its touch when that is over, and plans the next where `goes_on`.
    fn act(
        &mut self,
        world: &mut World,
        now: f64,
        delay: f64,
        goes_on: bool,
        random: &mut Random,
        count: &mut Count,
    ) {
        /// The wait of the events, two steps and a frame: after that the end is overdue.
        const OVERDUE: f64 = WAIT + 2.0 * STEP + 1.0 / RATE;
        if now > self.times[3] + OVERDUE {
            let expected = usize::from(!self.is_done);
            count.touches += expected;
            for found in [self.begun, self.ended] {
                count.missed += expected.saturating_sub(found);
                count.doubled += found.saturating_sub(expected);
            }
            (self.begun, self.ended, self.is_done) = (0, 0, !goes_on);
            if goes_on {
                self.plan(now + random.between(0.0, 0.1), random);
            }
        }
        let place = self.place(now, delay);
        let velocity = (self.place(now + STEP, delay) - place) / STEP;
        let mut body = world.body_mut(self.body);
        body.set_pose(&Isometry3::from(place.coords)).unwrap();
        body.set_linear_velocity(&velocity).unwrap();
    }

    fn place(&self, now: f64, delay: f64) -> Point3<f64> {
        let [start, inside, leaving, away] = self.times;
        let part = |from: f64, to: f64| ((now - from) / (to - from)).clamp(0.0, 1.0);
        let depth = part(start, inside) - part(leaving, away);
        let distance = APART + (TOUCHING - APART) * depth;
        centre(self.ball, (now - delay).max(0.0)) + self.direction * distance
    }
}

/// The noise of the masks, and a view that flickers.
#[derive(Default)]
struct Flicker {
    /// The view, what it does, and the frame at which it stops.
    now: Option<(usize, usize, usize)>,
    /// The frame up to which the next one waits.
    quiet_until: usize,
}

impl Flicker {
    fn masks(&mut self, clean: &[GrayImage], frame: usize, random: &mut Random) -> Vec<GrayImage> {
        if let Some((_, _, end)) = self.now.filter(|(_, _, end)| frame >= *end) {
            (self.now, self.quiet_until) = (None, end + 1);
        }
        if self.now.is_none() && frame >= self.quiet_until && random.unit() < FLICKER {
            let end = frame + 1 + random.below(LONGEST_FLICKER);
            self.now = Some((random.below(clean.len()), random.below(4_usize), end));
        }

        let noisy = |(view, mask): (usize, &GrayImage)| {
            let seed = (frame * clean.len() + view) as u64;
            let mask = displace_edge(mask, 1.0, seed);
            match self.now {
                Some((flickering, kind, _)) if flickering == view => flickered(mask, kind, seed),
                _ => mask,
            }
        };
        clean.iter().enumerate().map(noisy).collect()
    }
}

/// A mask of a view that flickers: it is empty, lacks a part, is speckled, or falls apart along a line.
fn flickered(mut mask: GrayImage, kind: usize, seed: u64) -> GrayImage {
    let mut random = Random(seed);
    match kind {
        0 => mask.fill(0),
        1 => {
            let subject: Vec<_> =
                mask.enumerate_pixels().filter(|(_, _, Luma([byte]))| *byte > 127).collect();
            let (i, j, _) = subject[random.below(subject.len())];
            return bitten(&mask, random.between(0.02, 0.3), &Point2::new(f64::from(i), f64::from(j)));
        }
        2 => return speckled(&mask, 0.03, seed),
        _ => {
            let row = 20 + random.below(80_u32);
            (0..mask.width()).for_each(|i| mask.put_pixel(i, row, Luma([0])));
        }
    }
    mask
}
