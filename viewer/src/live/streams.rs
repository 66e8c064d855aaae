//! How the real cameras are doing: what is lost and comes back is told.

use super::messages::Messages;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::StatusHandle;

/// The real cameras of a rig.
pub struct Streams(Vec<Stream>);

struct Stream {
    name: String,
    handle: StatusHandle,
    /// As it was told last.
    is_connected: bool,
    last_error: Option<String>,
}

impl Streams {
    /// The cameras of `rig`, whose sources have these `handles`.
    pub fn new(rig: &Rig, handles: Vec<StatusHandle>) -> Self {
        let stream = |(camera, handle): (&ode_visual_hull::camera::Camera, _)| Stream {
            name: camera.name().to_owned(),
            handle,
            is_connected: false,
            last_error: None,
        };
        Self(rig.cameras().iter().zip(handles).map(stream).collect())
    }

    /// Tells which cameras were lost or have come back since the last call.
    pub fn tell_changes(&mut self, messages: &Messages) {
        for stream in &mut self.0 {
            let status = stream.handle.status();
            let is_new_error = status.last_error != stream.last_error;
            if status.is_connected && !stream.is_connected {
                messages.tell(&stream.name, format!("{}: images arrive", stream.name));
            }
            if let Some(error) = status.last_error.as_ref().filter(|_| is_new_error) {
                let next = if status.is_connected { "the image is left out" } else { "trying again" };
                messages.warn(&stream.name, format!("{error}; {next}"));
            }
            (stream.is_connected, stream.last_error) = (status.is_connected, status.last_error);
        }
    }
}
