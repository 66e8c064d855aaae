//! Hulls of random solids in all kinds of rigs and masks.

use crate::edge_noise::displace_edge;
use crate::random::Random;
use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3, point, vector};
use ode_visual_hull::camera::{Camera, Distortion, Fisheye};
use ode_visual_hull::hull::{Aabb, EdgeModel, Hull, HullData, Unseen};
use ode_visual_hull::synthetic::{
    Placed, Solid, Subject, Texture, coverage, flip_boundary, layout, silhouette,
};
use std::sync::Arc;

const SIZE: (u32, u32) = (320, 240);
const FIELD_OF_VIEW: f64 = 0.5;
const DISTANCE: f64 = 2.5;
const TARGET: Point3<f64> = Point3::new(0.0, 0.0, 0.3);

/// The masks of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Masks {
    /// 0 and 255.
    Clean,
    /// With coverage.
    Coverage,
    /// With coverage, edges displaced by a pixel.
    Displaced,
    /// 0 and 255, a third of the boundary's pixels flipped.
    Flipped,
}

/// The lenses of a scene's cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Lens {
    None,
    Polynomial,
    Fisheye,
}

/// A hull to collide with.
pub struct Scene {
    /// What it is made of.
    pub name: String,
    /// The hull.
    pub hull: Arc<Hull>,
    /// Points inside it.
    pub inside: Vec<Point3<f64>>,
    /// Whether the masks have no coverage and no view is overruled, so that the reference describes the hull
    /// exactly.
    pub is_exactly_the_reference: bool,
}

/// `count` scenes, which differ in solids, rigs, masks, lenses and policies.
pub fn scenes(count: usize, seed: u64) -> Vec<Scene> {
    let mut random = Random(seed);
    (0..count).map(|k| scene(k, &mut random)).collect()
}

fn scene(k: usize, random: &mut Random) -> Scene {
    let masks = [Masks::Clean, Masks::Coverage, Masks::Displaced, Masks::Flipped][k % 4];
    let lens = [Lens::None, Lens::None, Lens::Polynomial, Lens::None, Lens::Fisheye][k % 5];
    let abstains = k % 3 == 1;
    let overrules = k % 7 == 6;
    let (solids, subject) = subject(k / 2, random);
    let (rig, cameras) = cameras(k / 3, lens, abstains, random);

    let data = HullData::new();
    data.add_views(&cameras).unwrap();
    data.set_bounds(Aabb::new(point![-0.7, -0.7, -0.3], point![0.7, 0.7, 0.9]).unwrap()).unwrap();
    data.set_unseen(if abstains { Unseen::ABSTAIN } else { Unseen::Outside }).unwrap();
    data.set_overrule_depth(overrules.then_some(0.04)).unwrap();
    for (view, camera) in cameras.iter().enumerate() {
        data.set_mask(view, &mask(camera, &subject, masks, random)).unwrap();
    }
    let hull = data.update(0.0).unwrap();

    let (min, max) = (hull.aabb().min, hull.aabb().max);
    let points = std::iter::repeat_with(|| random.point(min, max)).take(1_000_000);
    let inside: Vec<_> = points.filter(|p| hull.inside_by(p, EdgeModel::Coverage)).take(200).collect();
    let has_coverage = hull.views().iter().any(|view| view.silhouette().has_coverage());
    let name =
        format!("{k}: {solids}, {rig}, {masks:?}, lens {lens:?}, abstains {abstains}, overrules {overrules}");
    assert!(!inside.is_empty(), "{name}: expected points inside");
    Scene { name, hull, inside, is_exactly_the_reference: !has_coverage && !overrules }
}

fn subject(k: usize, random: &mut Random) -> (&'static str, Subject) {
    let placed = |solid: Solid, offset: Vector3<f64>, random: &mut Random| {
        let centre = TARGET + offset + random.direction() * 0.02;
        let pose = Isometry3::from_parts(centre.into(), random.rotation());
        Placed::new(solid, pose, Texture::plain([200; 3]))
    };
    let cuboid = || Solid::cuboid(vector![0.4, 0.3, 0.2]).unwrap();
    let none = Vector3::zeros();
    match k % 5 {
        0 => ("box", Subject::new(vec![placed(cuboid(), none, random)])),
        1 => ("ball", Subject::new(vec![placed(Solid::sphere(0.2).unwrap(), none, random)])),
        2 => ("torus", Subject::new(vec![placed(Solid::torus(0.2, 0.06).unwrap(), none, random)])),
        3 => {
            let limb = |offset: Vector3<f64>, random: &mut Random| {
                placed(Solid::capsule(0.04, 0.3).unwrap(), offset, random)
            };
            let offsets = [vector![0.12, 0.0, 0.0], vector![-0.1, 0.1, 0.05], vector![0.0, -0.12, -0.05]];
            ("three limbs", Subject::new(offsets.map(|offset| limb(offset, random)).to_vec()))
        }
        _ => {
            let ball = placed(Solid::sphere(0.1).unwrap(), vector![0.0, 0.0, 0.15], random);
            ("box and ball", Subject::new(vec![placed(cuboid(), none, random), ball]))
        }
    }
}

/// The rig's name and cameras. Where views abstain, every third camera sees a part of the subject only.
fn cameras(k: usize, lens: Lens, abstains: bool, random: &mut Random) -> (String, Vec<Camera>) {
    let n = 4 + random.below(4_usize);
    let rig = |fov: f64| match k % 3 {
        0 => ("ring", layout::ring(n, DISTANCE, 0.5, TARGET, SIZE, fov)),
        1 => ("hemisphere", layout::hemisphere(n, DISTANCE, TARGET, SIZE, fov)),
        _ => ("staggered", layout::staggered(n, DISTANCE, &[0.1, 1.2, 0.6], TARGET, SIZE, fov)),
    };
    let (name, wide) = rig(FIELD_OF_VIEW);
    let narrow = rig(0.2).1.unwrap();
    let mut cameras = wide.unwrap();
    for (camera, narrow) in cameras.iter_mut().zip(narrow).step_by(3) {
        if abstains {
            *camera = narrow;
        }
    }
    let cameras = cameras.into_iter().map(|camera| with_lens(camera, lens)).collect();
    (format!("{name} of {n}"), cameras)
}

fn with_lens(camera: Camera, lens: Lens) -> Camera {
    match lens {
        Lens::None => camera,
        Lens::Polynomial => {
            let barrel = Distortion::from_opencv(&[-0.2, 0.0, 0.0, 0.0]).unwrap();
            camera.with_lens(barrel).unwrap()
        }
        Lens::Fisheye => {
            camera.with_lens(Fisheye::from_opencv(&[0.01, -0.004, 5e-4, -2e-5]).unwrap()).unwrap()
        }
    }
}

fn mask(camera: &Camera, subject: &Subject, masks: Masks, random: &mut Random) -> GrayImage {
    let seed = random.below(1_u64 << 32);
    match masks {
        Masks::Clean => silhouette(camera, subject),
        Masks::Coverage => coverage(camera, subject),
        Masks::Displaced => displace_edge(&coverage(camera, subject), 1.0, seed),
        Masks::Flipped => {
            let mut mask = silhouette(camera, subject);
            flip_boundary(&mut mask, 0.37, seed).unwrap();
            mask
        }
    }
}
