//! Steadier pictures of a subject that stands still: noise of the images changes colours from frame to frame.

use crate::picture::{Content, Picture};
use nalgebra::{Matrix3x4, Point3};
use ode_visual_hull::camera::Camera;
use rayon::prelude::*;

/// The share of a new colour where the last picture shows the same place of a subject that stood still.
const NEW_SHARE: f32 = 0.35;

/// Surfaces whose depths differ by less than this part of the depth are the same.
const SAME_DEPTH: f32 = 0.015;

/// Colours that differ by less than this many grey levels in each channel are the same, but for noise.
const SAME_COLOUR: i32 = 20;

/// The last picture of a film, from which the next one takes what stood still.
#[derive(Debug, Default)]
pub struct History {
    last: Option<(Matrix3x4<f32>, Picture)>,
}

impl History {
    /// Mixes into `picture`, drawn from the place of `camera`, the colours that the last picture has at the same places of the
    /// subject, where neither depth nor colour differ by more than noise. It becomes the last picture.
    pub fn steady(&mut self, picture: &mut Picture, camera: &Camera) {
        if let Some((projection, last)) = &self.last {
            let width = picture.colour.width() as usize;
            let Picture { colour, content, depth } = &mut *picture;
            let rows =
                colour.par_chunks_mut(3 * width).zip(content.par_chunks(width)).zip(depth.par_chunks(width));
            rows.enumerate().for_each(|(y, ((colours, content), depths))| {
                let pixels = colours.chunks_exact_mut(3).zip(content).zip(depths).enumerate();
                for (x, ((colour, _), depth)) in
                    pixels.filter(|(_, ((_, content), _))| **content == Content::Subject)
                {
                    let place = camera.unproject(x as f64 + 0.5, y as f64 + 0.5, f64::from(*depth));
                    if let Some(before) =
                        place.and_then(|place| colour_before(projection, last, &place.cast()))
                    {
                        mix(colour, before);
                    }
                }
            });
        }
        self.last = Some((camera.projection_matrix().cast(), picture.clone()));
    }
}

/// The colour that the `last` picture has at `place`, a place of the subject's surface, if it shows it.
fn colour_before(projection: &Matrix3x4<f32>, last: &Picture, place: &Point3<f32>) -> Option<[u8; 3]> {
    let h = projection * place.to_homogeneous();
    let (u, v) = (h.x / h.z, h.y / h.z);
    let (width, height) = last.colour.dimensions();
    if !(h.z > 0.0 && u >= 0.0 && v >= 0.0 && u < width as f32 && v < height as f32) {
        return None;
    }
    let (x, y) = (u as u32, v as u32);
    let index = (y * width + x) as usize;
    let is_same = (last.depth[index] - h.z).abs() < SAME_DEPTH * h.z;
    (last.content[index] == Content::Subject && is_same).then(|| last.colour.get_pixel(x, y).0)
}

fn mix(colour: &mut [u8], before: [u8; 3]) {
    let differs = |(new, old): (&u8, &u8)| (i32::from(*new) - i32::from(*old)).abs() > SAME_COLOUR;
    if colour.iter().zip(&before).any(differs) {
        return;
    }
    for (new, old) in colour.iter_mut().zip(before) {
        *new = (f32::from(old) + NEW_SHARE * (f32::from(*new) - f32::from(old))).round() as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;
    use nalgebra::Vector3;

    /// A subject of one colour at a depth of 2 m that fills the picture.
    fn wall(level: u8) -> Picture {
        let mut picture = Picture::new(32, 24);
        picture.colour.pixels_mut().for_each(|pixel| *pixel = Rgb([level; 3]));
        picture.content.fill(Content::Subject);
        picture.depth.fill(2.0);
        picture
    }

    fn camera(x: f64) -> Camera {
        let eye = Point3::new(x, -2.0, 1.0);
        Camera::look_at("eye", (32, 24), 0.8, eye, Point3::new(x, 0.0, 1.0), Vector3::z()).unwrap()
    }

    fn second(first: &Picture, mut then: Picture, moved: f64) -> Picture {
        let mut history = History::default();
        history.steady(&mut first.clone(), &camera(0.0));
        history.steady(&mut then, &camera(moved));
        then
    }

    #[test]
    fn what_stands_still_changes_by_a_part_of_the_noise_also_from_a_moving_viewpoint() {
        for moved in [0.0, 0.3] {
            let picture = second(&wall(100), wall(110), moved);
            // 35 % of ten levels. From the side, the last picture does not show the left or right end.
            let steadied = picture.colour.pixels().filter(|pixel| pixel.0 == [104; 3]).count();
            assert!(steadied as f64 > 0.75 * 32.0 * 24.0, "{moved}: {steadied}");
        }
    }

    #[test]
    fn what_moved_or_changed_its_colour_is_drawn_as_it_is() {
        assert_eq!(second(&wall(100), wall(140), 0.0), wall(140));
        let mut nearer = wall(110);
        nearer.depth.fill(1.9);
        assert_eq!(second(&wall(100), nearer.clone(), 0.0), nearer);
        let mut bodies = wall(110);
        bodies.content.fill(Content::Body);
        assert_eq!(second(&wall(100), bodies.clone(), 0.0), bodies);
    }
}
