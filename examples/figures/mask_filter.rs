//! What the corrections of masks do to a hull: the volume that a bite out of one mask takes away, and what is left of
//! that where the other views overrule it.

use crate::studio::*;
use image::GrayImage;
use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::synthetic::{Subject, coverage, layout};
use ode_visual_hull_testing::captures;
use ode_visual_hull_testing::figure::Figure;
use ode_visual_hull_testing::mask_errors::{bitten, centroid};

/// Distance between the points of the grid on which volumes are measured, in metres.
const SPACING: f64 = 0.01;

/// The depth from which views overrule another, in metres.
const DEPTH: f64 = 0.02;

/// The view whose mask has a bite.
const BITTEN: usize = 2;

/// A subject's masks.
struct Scene {
    name: &'static str,
    cameras: Vec<Camera>,
    masks: Vec<GrayImage>,
    bounds: Aabb,
}

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut scenes = vec![walking_person("person_7_views", 7), walking_person("person_4_views", 4)];
    if let Some(dir) = captures::find("balancing_person") {
        let recording = Recording::open(&dir).expect("a recording");
        scenes.push(Scene {
            name: "balancing_person",
            cameras: recording.rig().cameras().to_vec(),
            masks: recording.masks(recording.frames()[0]).expect("masks"),
            bounds: captures::BALANCING,
        });
    }

    let mut figures = Vec::new();
    for scene in &scenes {
        progress(&format!("one view overruled, {}", scene.name));
        let mask = &scene.masks[BITTEN];
        let mut bitten_masks = scene.masks.clone();
        bitten_masks[BITTEN] = bitten(mask, 0.1, &centroid(mask));

        let whole = scene.volume(&scene.masks, None);
        let overruled = scene.volume(&scene.masks, Some(DEPTH));
        let lost = 1.0 - scene.volume(&bitten_masks, None) / whole;
        let lost_overruled = 1.0 - scene.volume(&bitten_masks, Some(DEPTH)) / whole;
        let mut add = |what: &str, value| {
            figures.push(Figure::reported(&format!("overrule_{what}_{}", scene.name), value));
        };
        add("inflation", overruled / whole - 1.0);
        add("bite_lost_without", lost);
        add("bite_lost", lost_overruled);
    }
    figures
}

/// A person in the middle of a ring of cameras at breast height.
fn walking_person(name: &'static str, count: usize) -> Scene {
    let (person, target) = (Subject::person_at(0.3), Point3::new(0.0, 0.0, 0.9));
    let cameras = layout::ring(count, 3.0, 1.4, target, (640, 480), 0.9).expect("a ring");
    let masks = masks(&cameras, &person, coverage);
    let half = Vector3::new(0.8, 0.8, 0.95);
    Scene { name, cameras, masks, bounds: Aabb { min: target - half, max: target + half } }
}

impl Scene {
    /// The volume of the hull of `masks`, in cubic metres.
    fn volume(&self, masks: &[GrayImage], overrule_depth: Option<f64>) -> f64 {
        let data = HullData::new();
        data.set_bounds(self.bounds).expect("a volume");
        data.add_views(&self.cameras).expect("names of their own");
        data.set_overrule_depth(overrule_depth).expect("a depth");
        for (view, mask) in masks.iter().enumerate() {
            data.set_mask(view, mask).expect("a mask of the camera's size");
        }
        captures::carve(&data.update(0.0).expect("masks in all views"), SPACING).0
    }
}
