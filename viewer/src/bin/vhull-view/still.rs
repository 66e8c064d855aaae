//! `vhull-view still`: one picture.

use crate::options::{DrawingOptions, parse_place, save, warn};
use nalgebra::Point3;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::VolumeOptions;
use ode_visual_hull_viewer::orbit::Orbit;
use ode_visual_hull_viewer::record::CapturedFrames;
use ode_visual_hull_viewer::scene::Scene;
use ode_visual_hull_viewer::supersample::{enlarged, reduced};
use std::path::PathBuf;

/// Draw one frame of a recording from a place of your choice.
///
/// World z is up, the floor at z = 0. From the place of a real camera (`--camera`) its own image is shown.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of a recording with masks and images.
    recording: PathBuf,
    /// Number of the frame [default: the first one with masks and images].
    #[arg(long, value_name = "N")]
    frame: Option<u32>,
    /// Where to write the picture.
    #[arg(long, short, value_name = "FILE", default_value = "still.png")]
    out: PathBuf,

    /// Place of the viewpoint, in metres [default: in front of the subject].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true, conflicts_with = "camera", help_heading = "Viewpoint")]
    eye: Option<Point3<f64>>,
    /// What is in the middle of the picture, in metres [default: the middle of the subject].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_place, allow_hyphen_values = true, conflicts_with = "camera", help_heading = "Viewpoint")]
    target: Option<Point3<f64>>,
    /// Horizontal angle of view, in degrees.
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 50.0,
        conflicts_with = "camera",
        help_heading = "Viewpoint"
    )]
    field_of_view: f64,
    /// The place and the picture's size of this real camera.
    #[arg(long, value_name = "NAME", conflicts_with = "size", help_heading = "Viewpoint")]
    camera: Option<String>,
    /// Draw the subject from the place of a real camera too, instead of showing its image.
    #[arg(long, help_heading = "Viewpoint")]
    no_snap: bool,

    #[command(flatten)]
    volume: VolumeOptions,
    #[command(flatten)]
    drawing: DrawingOptions,
}

const EXAMPLES: &str = "\
Examples:
  vhull-view still my_recording --eye 2.5,1,1.5            from this place, towards the subject
  vhull-view still my_recording --camera left --no-snap    drawn from the place of camera `left`
  vhull-view still my_recording --method hull              the shape alone";

pub fn run(options: &Options) -> Result<()> {
    let captured = CapturedFrames::open(&options.recording, &options.volume)?;
    let frame = options.frame.map_or_else(|| captured.first_frame(), Ok)?;
    let scene = captured.scene(frame)?;
    warn(&scene);

    let camera = viewpoint(options, &captured, &scene)?;
    if let Some(why) = scene.obstacle(&camera.centre()) {
        eprintln!("note: viewpoint: {why}");
    }
    let mut renderer = options.drawing.open()?;
    let samples = options.drawing.samples;
    let drawn = renderer.draw(
        &scene,
        &enlarged(&camera, samples)?,
        &options.drawing.draw_options(!options.no_snap),
    )?;
    save(&reduced(drawn, samples), &options.out)?;
    println!("frame {frame}, drawn by {}: {}", renderer.description(), options.out.display());
    Ok(())
}

fn viewpoint(options: &Options, captured: &CapturedFrames, scene: &Scene) -> Result<Camera> {
    let cameras = captured.cameras();
    if let Some(name) = &options.camera {
        let names = || cameras.cameras().iter().map(Camera::name);
        let view = names().position(|other| other == name).ok_or_else(|| {
            Error::argument(format!(
                "--camera: expected one of {}, found {name}",
                names().collect::<Vec<_>>().join(", ")
            ))
        })?;
        return Ok(cameras.pinhole(view).clone());
    }
    let subject = scene.hull.aabb();
    let target = options.target.unwrap_or(subject.centre());
    let field_of_view = options.field_of_view.to_radians();
    let azimuth = Orbit::from_eye(&scene.views[0].centre(), &target, field_of_view).azimuth;
    let eye = options.eye.unwrap_or_else(|| Orbit::around(subject, azimuth).eye());
    Orbit::from_eye(&eye, &target, field_of_view).camera(options.drawing.size)
}
