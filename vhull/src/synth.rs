//! `vhull synth`: a recording of a synthetic subject, so that every subcommand can be tried without cameras.

use crate::Outcome;
use crate::progress;
use clap::ValueEnum;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::synthetic::{
    Placed, Room, Scene, Solid, Subject, Texture, add_noise, clean_plate, coverage, layout, render_over,
};
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::FramesCsv;
use ode_visual_hull_film::parse_size;
use std::path::PathBuf;

/// Write a recording of a synthetic subject: images, backgrounds and masks of a ring of cameras.
///
/// The cameras stand 3.2 m around the subject at staggered heights, z up, the floor at z = 0, and record 30 frames a
/// second.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder to write; created if missing.
    dir: PathBuf,
    /// Number of cameras.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=64))]
    cameras: u32,
    /// Subject in front of the cameras.
    #[arg(long, value_enum, default_value_t = SubjectKind::Person)]
    subject: SubjectKind,
    /// Number of frames.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    frames: u32,
    /// Size of the images.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = parse_size)]
    size: (u32, u32),
    /// Sensor noise, in grey levels.
    #[arg(long, value_name = "SIGMA", default_value_t = 2.0)]
    noise: f64,
    /// Seed of the noise: the same seed gives the same recording.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write no masks, so that vhull segment can make them.
    #[arg(long)]
    no_masks: bool,
}

const EXAMPLES: &str = "\
Examples:
  vhull synth studio
  vhull synth studio --cameras 4 --subject box --frames 30 --size 320x240
  vhull synth studio --no-masks && vhull segment studio";

/// Values of `--subject`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SubjectKind {
    /// A person of 1.75 m who walks on the spot and waves.
    Person,
    /// A box of 0.5 x 0.5 x 0.7 m that turns.
    Box,
    /// A ball of 0.8 m that bounces.
    Ball,
    /// An upright ring of 1.2 m that turns.
    Ring,
}

/// Frames per second.
const RATE: f64 = 30.0;

/// Horizontal distance of the cameras from the subject, in metres.
const RADIUS: f64 = 3.2;

/// Heights of the cameras above the floor, repeated around the ring, in metres.
const HEIGHTS: [f64; 3] = [0.5, 1.6, 2.4];

/// Point that the cameras look at, in metres.
const TARGET: Point3<f64> = Point3::new(0.0, 0.0, 0.9);

/// Field of view along the shorter side of the image, in radians.
const FIELD_OF_VIEW: f64 = 0.8;

pub fn run(options: &Options) -> Result<Outcome> {
    let rig = Rig::new(cameras(options)?)?;
    let room = Room::default();
    let mut recording = Recording::create(&options.dir, &rig)?;
    let plates: Vec<_> = rig.cameras().iter().map(|camera| clean_plate(camera, &room)).collect();

    // Each image gets noise of its own: the seed in the low bits, the number of the image in the high ones.
    let mut exposures = 0;
    let mut expose = |image: &image::RgbImage| {
        let mut image = image.clone();
        exposures += 1;
        add_noise(&mut image, options.noise, options.seed.wrapping_add(exposures << 32))?;
        Ok(image)
    };
    recording.write_backgrounds(&plates.iter().map(&mut expose).collect::<Result<Vec<_>>>()?)?;

    let mut times = FramesCsv::open(&options.dir, None)?;
    let bar = progress::bar(options.frames as usize, "frames");
    for frame in 0..options.frames {
        let scene = Scene { subject: subject(options.subject, f64::from(frame) / RATE)?, room: room.clone() };
        let render =
            |(camera, plate): (&Camera, &image::RgbImage)| expose(&render_over(camera, &scene, plate)?);
        let images = rig.cameras().iter().zip(&plates).map(render).collect::<Result<Vec<_>>>()?;
        recording.write_images(frame, &images)?;

        if !options.no_masks {
            let masks: Vec<_> = rig.cameras().iter().map(|camera| coverage(camera, &scene.subject)).collect();
            recording.write_masks(frame, &masks)?;
        }
        if let Some(times) = &mut times {
            times.add(frame, f64::from(frame) / RATE)?;
        }
        bar.inc(1);
    }

    bar.finish_and_clear();
    println!("{} frames of {} cameras in {}", options.frames, rig.len(), options.dir.display());
    Ok(Outcome::Done)
}

/// A ring of cameras at staggered heights around [`TARGET`].
fn cameras(options: &Options) -> Result<Vec<Camera>> {
    if !(0.0..=100.0).contains(&options.noise) {
        return Err(Error::argument(format!(
            "--noise: expected 0 to 100 grey levels, found {}",
            options.noise
        )));
    }

    // The field of view is given along the shorter side; the layout takes the horizontal one.
    let (width, height) = options.size;
    let shorter = f64::from(width.min(height));
    let focal = 0.5 * shorter / (0.5 * FIELD_OF_VIEW).tan();
    let horizontal = 2.0 * (0.5 * f64::from(width) / focal).atan();
    layout::staggered(options.cameras as usize, RADIUS, &HEIGHTS, TARGET, options.size, horizontal)
}

/// The subject at time `t` in seconds, standing on the floor at the origin.
fn subject(kind: SubjectKind, t: f64) -> Result<Subject> {
    let placed = |solid, height: f64, rotation: UnitQuaternion<f64>, colour| {
        let pose = Isometry3::from_parts(Vector3::new(0.0, 0.0, height).into(), rotation);
        Subject::new(vec![Placed::new(solid, pose, Texture::cloth(colour))])
    };
    let about_z = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.3 + t);
    let upright = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.5 * std::f64::consts::PI);

    Ok(match kind {
        SubjectKind::Person => Subject::person_at(t),
        SubjectKind::Box => {
            placed(Solid::cuboid(Vector3::new(0.5, 0.5, 0.7))?, 0.35, about_z, [206, 120, 62])
        }
        SubjectKind::Ball => {
            placed(Solid::sphere(0.4)?, 0.4 + 0.6 * (4.0 * t).sin().abs(), about_z, [200, 60, 60])
        }
        SubjectKind::Ring => placed(Solid::torus(0.5, 0.1)?, 0.8, about_z * upright, [70, 90, 200]),
    })
}
