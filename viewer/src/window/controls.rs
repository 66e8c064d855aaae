//! What mouse and keys do: moves of the viewpoint, and actions. It needs no window.

use super::keys::Key;
use crate::live::{Command, Marks, Request, Viewpoint};
use crate::orbit::Orbit;
use crate::picture::Method;
use nalgebra::Point3;
use ode_visual_hull::camera::{Camera, Ray};
use std::collections::HashSet;

/// Radians of a turn for a pixel of a drag.
const TURN_PER_PIXEL: f64 = 0.008;

/// By what factor a notch of the wheel brings the eye nearer.
const ZOOM_PER_NOTCH: f64 = 0.88;

/// How fast the viewpoint flies, in distances from its target a second.
const FLIGHT_SPEED: f64 = 0.6;

/// A mouse that has moved by fewer pixels between press and release has clicked.
const CLICK_PIXELS: f64 = 4.0;

/// Seconds after the last notch of the wheel for which pictures are coarse.
const SETTLING: f64 = 0.25;

/// A button of the mouse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    /// Turns, and throws by a click.
    Left,
    /// Takes a body, or moves the view.
    Right,
}

/// What mouse and keyboard do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Input {
    /// A key goes down; while it is held down it does not come again.
    Press(Key),
    /// A key goes up.
    Release(Key),
    /// The mouse moves to this place, in pixels from the window's upper left corner.
    Move(f64, f64),
    /// A button goes down.
    ButtonDown(Button),
    /// A button goes up.
    ButtonUp(Button),
    /// The wheel turns away from the user by so many notches.
    Wheel(f64),
    /// The window has another size, in pixels.
    Resize(u32, u32),
    /// The window is no longer in front: keys and buttons go up unseen.
    FocusLost,
}

/// What is to be done besides another picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Action {
    /// Something with the bodies.
    Command(Command),
    /// Freeze time, or let it go on.
    Freeze,
    /// Go on by one frame.
    Step,
    /// Learn the empty room.
    Learn,
    /// Write the picture that is shown to a file.
    TakePicture,
    /// End.
    Quit,
}

/// The state of viewpoint, toggles, mouse and keys.
#[derive(Debug)]
pub struct Controls {
    cameras: Vec<Camera>,
    home: Orbit,
    request: Request,
    mouse: (f64, f64),
    drag: Option<Drag>,
    pressed: HashSet<Key>,
    /// Seconds for which pictures are coarse.
    settling: f64,
}

#[derive(Debug)]
struct Drag {
    button: Button,
    /// How far the mouse has moved, in pixels.
    length: f64,
    /// Whether a body may be held.
    with_body: bool,
}

impl Controls {
    /// The controls of a window of `size` pixels that shows what `home` shows, with these real `cameras`, pinholes.
    pub fn new(cameras: Vec<Camera>, home: Orbit, size: (u32, u32), method: Method, refine: bool) -> Self {
        let marks = Marks { info: true, ..Marks::default() };
        let request =
            Request { viewpoint: Viewpoint::Free(home), size, coarseness: 1, method, refine, marks };
        Self { cameras, home, request, mouse: (0.0, 0.0), drag: None, pressed: HashSet::new(), settling: 0.0 }
    }

    /// The picture to draw now.
    pub fn request(&self) -> Request {
        let is_moving = self.settling > 0.0 || self.is_flying() || self.is_turning();
        Request { coarseness: if is_moving { 2 } else { 1 }, ..self.request }
    }

    /// Whether the viewpoint changes with time.
    pub fn is_moving(&self) -> bool {
        self.settling > 0.0 || self.is_flying()
    }

    /// Lets time pass, in seconds, in which the viewpoint flies on.
    pub fn advance(&mut self, seconds: f64) {
        self.settling = (self.settling - seconds).max(0.0);
        if !self.is_flying() {
            return;
        }
        let along = |more: char, less: char| {
            let held = |key: char| f64::from(u8::from(self.pressed.contains(&Key::Char(key))));
            held(more) - held(less)
        };
        let (right, up, forward) = (along('d', 'a'), along('e', 'q'), along('w', 's'));
        let orbit = self.orbit();
        let length = FLIGHT_SPEED * orbit.distance * seconds;
        self.fly_to(orbit.moved(right * length, up * length, forward * length));
    }

    /// Takes an input; what is to be done.
    pub fn take(&mut self, input: Input) -> Option<Action> {
        match input {
            Input::Press(key) => self.press(key),
            Input::Release(key) => {
                self.pressed.remove(&key);
                None
            }
            Input::Move(x, y) => self.move_to(x, y),
            Input::ButtonDown(button) => self.button_down(button),
            Input::ButtonUp(button) => self.button_up(button),
            Input::Wheel(notches) => {
                self.fly_to(self.orbit().zoomed(ZOOM_PER_NOTCH.powf(notches)));
                self.settling = SETTLING;
                None
            }
            Input::Resize(width, height) => {
                self.request.size = (width, height);
                None
            }
            Input::FocusLost => {
                self.pressed.clear();
                self.drag.take().filter(|drag| drag.with_body).map(|_| Action::Command(Command::Release))
            }
        }
    }

    fn press(&mut self, key: Key) -> Option<Action> {
        self.pressed.insert(key);
        let Key::Char(key) = key else { return Some(Action::Quit) };
        let marks = &mut self.request.marks;
        match key {
            'c' => marks.contacts = !marks.contacts,
            'p' => marks.samples = !marks.samples,
            'k' => marks.cameras = !marks.cameras,
            'x' => marks.axes = !marks.axes,
            'v' => marks.work_volume = !marks.work_volume,
            'i' => marks.info = !marks.info,
            '?' => marks.keys = !marks.keys,
            'f' => self.request.refine = !self.request.refine,
            'h' => self.request.method = other_than(self.request.method, Method::Hull),
            'm' => self.request.method = other_than(self.request.method, Method::Sweep),
            '0' => self.request.viewpoint = Viewpoint::Free(self.home),
            '1'..='8' => {
                let view = key as usize - '1' as usize;
                if view < self.cameras.len() {
                    self.request.viewpoint = Viewpoint::Camera(view);
                }
            }
            ' ' => return Some(Action::Freeze),
            '.' => return Some(Action::Step),
            'l' => return Some(Action::Learn),
            't' => return Some(Action::TakePicture),
            'r' => return Some(Action::Command(Command::Reset)),
            'b' => return Some(Action::Command(Command::NextScenery)),
            _ => {}
        }
        None
    }

    fn move_to(&mut self, x: f64, y: f64) -> Option<Action> {
        let (dx, dy) = (x - self.mouse.0, y - self.mouse.1);
        self.mouse = (x, y);
        let drag = self.drag.as_mut()?;
        drag.length += dx.hypot(dy);
        let (button, with_body) = (drag.button, drag.with_body);
        if drag.length < CLICK_PIXELS {
            return None;
        }
        match button {
            Button::Left => self.fly_to(self.orbit().turned(-TURN_PER_PIXEL * dx, TURN_PER_PIXEL * dy)),
            Button::Right if with_body => return self.ray().map(|ray| Action::Command(Command::Drag(ray))),
            Button::Right => {
                let orbit = self.orbit();
                let metres = 2.0 * orbit.distance * (0.5 * orbit.field_of_view).tan();
                let pixel = metres / f64::from(self.request.size.0.max(1));
                self.fly_to(orbit.moved(-dx * pixel, dy * pixel, 0.0));
            }
        }
        None
    }

    fn button_down(&mut self, button: Button) -> Option<Action> {
        let ray = self.ray().filter(|_| button == Button::Right);
        self.drag = Some(Drag { button, length: 0.0, with_body: false });
        ray.map(|ray| Action::Command(Command::Grab(ray)))
    }

    fn button_up(&mut self, button: Button) -> Option<Action> {
        let drag = self.drag.take().filter(|drag| drag.button == button)?;
        match button {
            Button::Left if drag.length < CLICK_PIXELS => {
                self.ray().map(|ray| Action::Command(Command::Throw(ray)))
            }
            Button::Left => None,
            Button::Right => Some(Action::Command(Command::Release)),
        }
    }

    /// Says whether the drag that has begun holds a body: it then moves that instead of the view.
    pub fn holds_body(&mut self, holds: bool) {
        if let Some(drag) = &mut self.drag {
            drag.with_body = holds;
        }
    }

    /// The ray through the mouse.
    fn ray(&self) -> Option<Ray> {
        let request = Request { coarseness: 1, ..self.request };
        let camera = request.camera(|view| &self.cameras[view]).ok()?;
        camera.ray(self.mouse.0 + 0.5, self.mouse.1 + 0.5)
    }

    /// The viewpoint from which to move on: that of a real camera looks at what is in its middle, as far away as the subject.
    fn orbit(&self) -> Orbit {
        match self.request.viewpoint {
            Viewpoint::Free(orbit) => orbit,
            Viewpoint::Camera(view) => {
                let camera = &self.cameras[view];
                let distance = (camera.centre() - self.home.target).norm();
                let target: Point3<f64> = camera.centre() + camera.forward() * distance;
                let half = 0.5 * f64::from(camera.size().0) / camera.intrinsics()[(0, 0)];
                Orbit::from_eye(&camera.centre(), &target, 2.0 * half.atan())
            }
        }
    }

    fn fly_to(&mut self, orbit: Orbit) {
        self.request.viewpoint = Viewpoint::Free(orbit);
    }

    fn is_flying(&self) -> bool {
        ['w', 'a', 's', 'd', 'q', 'e'].iter().any(|key| self.pressed.contains(&Key::Char(*key)))
    }

    fn is_turning(&self) -> bool {
        self.drag.as_ref().is_some_and(|drag| !drag.with_body && drag.length >= CLICK_PIXELS)
    }
}

/// `other`, or the method blend where that is in use already.
fn other_than(method: Method, other: Method) -> Method {
    if method == other { Method::Blend } else { other }
}

#[cfg(test)]
mod tests;
