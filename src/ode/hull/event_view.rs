//! Contact events of hull geoms in a [`World`].

use super::class;
use super::events::{HullEventKind, TouchEvent, Toucher};
use super::view::{HullMut, HullView};
use crate::Result;
use crate::ode::arena::{BodyId, GeomId};
use crate::ode::world::World;
use nalgebra::{Point3, Vector3};
use ode_sys::{dBodyID, dGeomID};

/// A touch of a body and a part of a visual hull has begun or ended.
///
/// A part is what the cameras see as separate: pieces of the hull whose images are connected in most of the views are one
/// part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HullEvent {
    /// Whether it has begun or ended.
    pub kind: HullEventKind,
    /// The body; `None` for a geom without one. It may have been removed since.
    pub body: Option<BodyId>,
    /// The geom: of several geoms of the body, that of the deepest contact. It may have been removed since.
    pub geom: GeomId,
    /// The part of the hull, from 1 on. A part keeps its number while it moves, and no other part of this geom gets it.
    pub part: u32,
    /// The time of the first contact or of the last one, in seconds, by the clock of [`HullMut::set_time`]. Where that is not
    /// called: the sum of the lengths of all steps since events were switched on.
    pub time: f64,
    /// The position of the deepest contact of the first step, or of the whole touch, in the world's frame.
    pub position: Point3<f64>,
    /// The unit normal of that contact, out of the hull, in the world's frame.
    pub normal: Vector3<f64>,
    /// How fast the depth grew, in m/s: in the first step, or the most in the whole touch. It is the speed of the body against
    /// the surface, along the normal, before the contact acts; 0 where the two part. Where the hull is in
    /// [`Motion`](crate::hull::Motion), the surface has its own velocity, and rests otherwise.
    pub depth_rate: f64,
}

/// The contact events of a step: see [`HullMut::events`].
#[derive(Debug)]
pub struct HullEvents(std::vec::IntoIter<HullEvent>);

impl Iterator for HullEvents {
    type Item = HullEvent;

    fn next(&mut self) -> Option<HullEvent> {
        self.0.next()
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.0.size_hint()
    }
}

impl ExactSizeIterator for HullEvents {}

impl HullEvent {
    /// The event with ids; `None` for what is not of a world.
    fn of(event: TouchEvent) -> Option<Self> {
        let TouchEvent { kind, toucher, part, time, position, normal, depth_rate } = event;
        let (geom, body) = toucher.ids?;
        Some(Self { kind, body, geom, part, time, position, normal, depth_rate })
    }
}

impl HullView<'_> {
    /// Whether contacts are recorded as [events](HullMut::events).
    pub fn has_events(&self) -> bool {
        self.hull.has_events()
    }

    /// How long a touch waits for its next contact before it ends, in seconds.
    pub fn event_wait(&self) -> f64 {
        self.hull.event_wait()
    }
}

impl HullMut<'_> {
    /// Switches contact events on or off; they are off by default. Switched off, touches that go on are forgotten without an
    /// event.
    pub fn set_events(&mut self, on: bool) {
        self.view.hull.set_events(on);
        if on {
            self.view.world.has_events.set(true);
        }
    }

    /// Sets how long a touch waits for its next contact before it ends, in seconds; 0.1 by default, three frames of 30 a
    /// second. Within that time a mask may flicker, or a body bounce, and the touch goes on; its end tells the time of the last
    /// contact.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) unless it is finite and not negative.
    pub fn set_event_wait(&mut self, seconds: f64) -> Result<()> {
        self.view.hull.set_event_wait(seconds)
    }

    /// Takes the contact events up to the last [`World::collide`], in the order in which they occurred: a touch begins with the
    /// first contact of a body, or of a geom without one, with a part of the hull. It ends when there was none for
    /// [`event_wait`](HullView::event_wait). Nothing is lost where a step's events are not taken: they come with the next
    /// ones. The order and all numbers are the same in each run.
    ///
    /// Contacts that have not begun, with a hull that is [`Swept`](super::Swept), count: a touch begins at the time that they
    /// tell. Queries, such as [`World::collide_geoms`], do not count.
    ///
    /// A body that falls asleep at the hull, or sticks to it ([`HullMut::hold`]), goes on touching it. One that is removed or disabled, or whose geoms are, ends its
    /// touches as one that leaves. [`HullMut::set_data`] ends all touches, and the parts of other data have new numbers. With
    /// the hull's geom, the events that were not taken are removed.
    ///
    /// Two parts that become one, as the cameras see it, go on as the larger of them; of a part that comes apart, the larger
    /// piece keeps the number, and the other has one of its own after 0.1 s.
    ///
    /// ```
    /// # use nalgebra::{Isometry3, Point3, Vector3};
    /// # use ode_visual_hull::hull::{Aabb, HullData};
    /// # use ode_visual_hull::ode::{Amount, HullEventKind, Mass, Ode, Shape, Surface, World};
    /// # use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, layout, silhouette};
    /// # use std::sync::Arc;
    /// # fn main() -> ode_visual_hull::Result<()> {
    /// # let (sides, origin) = (Vector3::new(0.5, 0.5, 0.4), Isometry3::identity());
    /// # let table = Subject::new(vec![Placed::new(Solid::cuboid(sides)?, origin, Texture::plain([200; 3]))]);
    /// # let data = Arc::new(HullData::new());
    /// # data.set_bounds(Aabb::new(Point3::new(-0.6, -0.6, -0.3), Point3::new(0.6, 0.6, 0.8))?)?;
    /// # for camera in layout::face_on(sides, &origin, 2.8, 0.2, (320, 240), 0.45)? {
    /// #     data.set_mask(data.add_view(camera.clone())?, &silhouette(&camera, &table))?;
    /// # }
    /// # data.update(0.0)?;
    /// # let mut world = World::new(&Ode::init()?)?;
    /// # world.set_gravity(&Vector3::new(0.0, 0.0, -9.81))?;
    /// # let root = world.root_space();
    /// // A ball falls onto a table, whose top is at z = 0.2 m.
    /// let hull = world.add_hull(root, &data)?;
    /// world.hull_mut(hull).set_events(true);
    /// let (ball, shape) = (world.add_body(), Shape::Sphere { radius: 0.05 });
    /// let geom = world.add_geom(root, &shape)?;
    /// world.geom_mut(geom).set_body(Some(ball))?;
    /// world.body_mut(ball).set_mass(&Mass::of(&shape, Amount::Total(0.1))?)?;
    /// world.body_mut(ball).set_pose(&Isometry3::translation(0.0, 0.0, 0.45))?;
    ///
    /// let mut events = Vec::new();
    /// for _ in 0..100 {
    ///     world.default_collide(&Surface::default(), 8)?;
    ///     events.extend(world.hull_mut(hull).events()?);
    ///     world.quick_step(0.005)?;
    /// }
    /// // From 0.2 m it falls for 0.2 s, and hits the table at 2 m/s.
    /// let [event] = events[..] else { panic!("{events:?}") };
    /// assert_eq!((event.kind, event.body, event.part), (HullEventKind::Begin, Some(ball), 1));
    /// assert!((event.time - 0.2).abs() < 0.01 && (event.depth_rate - 2.0).abs() < 0.1 && event.normal.z > 0.99);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Argument`](crate::Error::Argument) while events are off.
    pub fn events(&mut self) -> Result<HullEvents> {
        let mut events = Vec::new();
        self.view.hull.fetch_events(usize::MAX, |event| events.extend(HullEvent::of(event)))?;
        Ok(HullEvents(events.into_iter()))
    }
}

impl World {
    /// Begins a step of all hulls that record events. Runs before each collide.
    pub(in crate::ode) fn begin_event_steps(&self) {
        if !self.has_events.get() {
            return;
        }
        for (_, record) in self.geoms.iter() {
            if let Some(hull) = class::find(record.raw) {
                hull.step_size.tell(self.last_dt);
                hull.begin_event_step();
            }
        }
    }

    /// Tells the ids of what has touched hulls in the collide that has just ended. Nothing has been removed since.
    pub(in crate::ode) fn identify_touchers(&self) {
        if !self.has_events.get() {
            return;
        }
        let ids = |toucher: &Toucher| {
            // SAFETY: the collide has passed living geoms and bodies, and the world was borrowed since.
            unsafe {
                let geom = self.geom_id(toucher.geom as dGeomID)?;
                Some((geom, self.body_id(toucher.body as dBodyID)))
            }
        };
        for (_, record) in self.geoms.iter() {
            if let Some(hull) = class::find(record.raw) {
                hull.identify_touchers(ids);
            }
        }
    }
}
