//! What is drawn over the picture in the world: contacts, samples, cameras, axes, work volume.

use super::request::Request;
use super::simulate::WorldState;
use crate::overlay::Overlay;
use crate::picture::Picture;
use crate::scene::{RealCameras, Scene};
use ode_visual_hull::camera::Camera;

/// Lengths of a camera's frustum and of the world's axes, in metres.
const FRUSTUM: f64 = 0.35;
const AXES: f64 = 0.5;

const CAMERA_COLOUR: [u8; 3] = [90, 170, 255];
const VOLUME_COLOUR: [u8; 3] = [170, 90, 220];

/// Draws the marks that `request` asks for, as seen from the place of `viewpoint`.
pub fn draw(
    picture: &mut Picture,
    viewpoint: &Camera,
    request: &Request,
    scene: &Scene,
    world: Option<&WorldState>,
    cameras: &RealCameras,
) {
    let (marks, mut overlay) = (&request.marks, Overlay::new());
    if marks.work_volume {
        overlay.add_box(scene.hull.bounds(), VOLUME_COLOUR);
    }
    if marks.axes {
        overlay.add_axes(AXES);
    }
    if marks.cameras {
        for (view, camera) in cameras.cameras().iter().enumerate() {
            let label = format!("{} {}", view + 1, camera.name());
            overlay.add_camera(cameras.pinhole(view), FRUSTUM, CAMERA_COLOUR, &label);
        }
    }
    if marks.samples {
        world.into_iter().flat_map(|world| &world.samples).for_each(|sample| overlay.add_sample(*sample));
    }
    if marks.contacts {
        for contact in world.into_iter().flat_map(|world| &world.contacts) {
            overlay.add_contact(contact.position, contact.normal, contact.depth, contact.velocity);
        }
    }
    overlay.draw(picture, viewpoint);
}
