//! Colour and depth images of a subject in a room, by ray casting.
//!
//! Shading is Lambertian without shadows, neither on the subject nor cast by it, so a colour that differs from the
//! clean plate is the subject's own. Outside the subject an image equals the clean plate byte for byte; at its outline
//! the two are mixed by area, as in a real camera.

use super::eye::{Eye, Patch, PatchContent};
use super::room::Room;
use super::solid::Solid;
use super::subject::{Placed, Subject, nearest_hit};
use crate::camera::{Camera, Ray};
use crate::{Error, Result};
use image::{Rgb, RgbImage};
use nalgebra::Vector3;

/// Rays along a pixel's side for the room.
const ROOM_RAYS: u32 = 2;
/// Rays along a pixel's side for a subject's outline and edges.
const EDGE_RAYS: u32 = 3;

/// A subject in a room.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// The subject in front of the cameras.
    pub subject: Subject,
    /// The room around it.
    pub room: Room,
}

/// Renders the scene's colour image.
pub fn render(camera: &Camera, scene: &Scene) -> RgbImage {
    let mut image = clean_plate(camera, &scene.room);
    paint_subject(camera, scene, &mut image);
    image
}

/// Renders like [`render`], but over a given [`clean_plate`], which is much faster if the room is rendered repeatedly.
///
/// # Errors
/// A clean plate of another size than the camera's.
pub fn render_over(camera: &Camera, scene: &Scene, clean_plate: &RgbImage) -> Result<RgbImage> {
    let (width, height) = camera.size();
    let found = clean_plate.dimensions();
    if found != (width, height) {
        let problem = format!(
            "expected a clean plate of {width} x {height} pixels, found {} x {}; render one for this camera",
            found.0, found.1
        );
        return Err(Error::view(camera.name(), problem));
    }

    let mut image = clean_plate.clone();
    paint_subject(camera, scene, &mut image);
    Ok(image)
}

/// Renders the colour image of the empty room. A pixel beyond the lens model is black.
pub fn clean_plate(camera: &Camera, room: &Room) -> RgbImage {
    let (width, height) = camera.size();
    let mut image = RgbImage::new(width, height);
    let eye = Eye::new(camera);
    for tile in eye.image_tiles() {
        eye.for_each_pixel(&tile, |x, y, patch| {
            let sum: Vector3<f64> = patch.rays(ROOM_RAYS).map(|ray| room.colour(&ray)).sum();
            image.put_pixel(x, y, rgb(sum / f64::from(ROOM_RAYS * ROOM_RAYS)));
        });
    }
    image
}

/// Depths in metres along the camera's z axis at the pixels' centres, row by row: of the subject, else the room, else
/// infinity.
pub fn render_depth(camera: &Camera, scene: &Scene) -> Vec<f32> {
    let (width, height) = camera.size();
    let mut depths = vec![f32::INFINITY; width as usize * height as usize];
    let eye = Eye::new(camera);
    let index = |x: u32, y: u32| y as usize * width as usize + x as usize;

    for (x, y) in eye.image_tiles().flat_map(|tile| tile.pixels()) {
        let Some(ray) = eye.ray(f64::from(x) + 0.5, f64::from(y) + 0.5) else { continue };
        if let Some((t, _)) = scene.room.far_side(&ray) {
            depths[index(x, y)] = eye.depth(&ray, t) as f32;
        }
    }

    for (tile, solids) in eye.tiles_with(&scene.subject) {
        for (x, y) in tile.pixels() {
            let Some(ray) = eye.ray(f64::from(x) + 0.5, f64::from(y) + 0.5) else { continue };
            if let Some((hit, _)) = nearest_hit(solids.iter().copied(), &ray) {
                depths[index(x, y)] = eye.depth(&ray, hit.t) as f32;
            }
        }
    }
    depths
}

/// Draws the subject over the empty room.
fn paint_subject(camera: &Camera, scene: &Scene, image: &mut RgbImage) {
    let eye = Eye::new(camera);
    let mut met = Vec::new();
    for (tile, solids) in eye.tiles_with(&scene.subject) {
        eye.for_each_pixel(&tile, |x, y, patch| {
            let content = patch.content(&solids, &mut met);
            if content == PatchContent::Background {
                return;
            }

            // Within a single round solid there is no edge to smooth, and one ray is enough.
            let is_smooth = content == PatchContent::Subject
                && met.len() == 1
                && !matches!(met[0].solid(), Solid::Cuboid { .. });
            let (colour, fraction) =
                mean_colour(&patch, &met, &scene.room, if is_smooth { 1 } else { EDGE_RAYS });

            let pixel = image.get_pixel_mut(x, y);
            let room = Vector3::from(pixel.0.map(f64::from));
            *pixel = rgb(room * (1.0 - fraction) + colour);
        });
    }
}

/// The mean colour of the rays of `patch` that meet `solids`, times their fraction, and that fraction.
fn mean_colour(patch: &Patch, solids: &[&Placed], room: &Room, n: u32) -> (Vector3<f64>, f64) {
    let mut sum = Vector3::zeros();
    let mut hits = 0.0;
    for ray in patch.rays(n) {
        if let Some(colour) = solid_colour(solids, room, &ray) {
            sum += colour;
            hits += 1.0;
        }
    }
    let rays = f64::from(n * n);
    (sum / rays, hits / rays)
}

/// The shaded colour of the nearest solid on a ray.
fn solid_colour(solids: &[&Placed], room: &Room, ray: &Ray) -> Option<Vector3<f64>> {
    let (hit, placed) = nearest_hit(solids.iter().copied(), ray)?;
    let point = ray.at(hit.t);
    let own = placed.texture().at(&placed.world_from_solid().inverse_transform_point(&point));
    Some(own * room.light(&point, &hit.normal))
}

fn rgb(colour: Vector3<f64>) -> Rgb<u8> {
    Rgb(colour.map(|c| c.round().clamp(0.0, 255.0) as u8).into())
}
