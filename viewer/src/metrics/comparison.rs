//! A picture drawn from the place of a real camera beside what that camera saw.

use super::{intersection_over_union, psnr, structural_similarity};
use crate::picture::{Content, Picture};
use crate::scene::SceneView;
use image::{Rgb, RgbImage};

/// What a real camera saw of the subject.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Its image, black outside the silhouette.
    pub image: RgbImage,
    /// Whether each pixel belongs to the silhouette, row by row.
    pub mask: Vec<bool>,
}

/// How close a picture comes to the truth.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// Peak signal-to-noise ratio over all pixels that belong to the subject in the truth or in the picture, in dB; where the
    /// other one has no subject it is black.
    pub psnr: f64,
    /// That over the pixels that belong to the subject in both.
    pub psnr_of_both: f64,
    /// Structural similarity over the pixels of either.
    pub ssim: f64,
    /// Pixels of both over pixels of either.
    pub iou: f64,
    /// The number of pixels of the truth's subject that show none in the picture.
    pub holes: usize,
}

impl Truth {
    /// What `view` saw; `None` where its image is missing.
    pub fn of(view: &SceneView) -> Option<Self> {
        let mut image = view.photo()?.clone();
        let is_subject = |x: u32, y: u32| view.is_subject(x as i32, y as i32);
        let mask: Vec<bool> = image.enumerate_pixels().map(|(x, y, _)| is_subject(x, y)).collect();
        for (pixel, _) in image.pixels_mut().zip(&mask).filter(|(_, subject)| !**subject) {
            *pixel = Rgb([0; 3]);
        }
        Some(Self { image, mask })
    }

    /// Compares `picture`, drawn from the place of this camera without surroundings, shadows and bodies.
    pub fn compare(&self, picture: &Picture) -> Comparison {
        let drawn: Vec<bool> = picture.content.iter().map(|content| *content == Content::Subject).collect();
        let combined = |both: fn(bool, bool) -> bool| -> Vec<bool> {
            self.mask.iter().zip(&drawn).map(|(a, b)| both(*a, *b)).collect()
        };
        let (either, both) = (combined(|a, b| a || b), combined(|a, b| a && b));
        let holes = combined(|truth, drawn| truth && !drawn);
        Comparison {
            psnr: psnr(&picture.colour, &self.image, &either),
            psnr_of_both: psnr(&picture.colour, &self.image, &both),
            ssim: structural_similarity(&picture.colour, &self.image, &either),
            iou: intersection_over_union(&self.mask, &drawn),
            holes: holes.into_iter().filter(|hole| *hole).count(),
        }
    }
}

impl Comparison {
    /// The mean of several comparisons; the holes of all.
    pub fn mean(all: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        Self {
            psnr: mean(|one| one.psnr),
            psnr_of_both: mean(|one| one.psnr_of_both),
            ssim: mean(|one| one.ssim),
            iou: mean(|one| one.iou),
            holes: all.iter().map(|one| one.holes).sum(),
        }
    }
}
