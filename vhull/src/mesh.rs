//! `vhull mesh`: hulls of a recording as closed triangle meshes.

mod field;
mod surface;

use crate::Outcome;
use crate::arguments::{open_recording, parse_length};
use crate::output::make_folder_of;
use crate::progress;
use field::SignedField;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{RecordedHulls, VolumeOptions, parse_frames, shown_frames};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use surface::Surface;

/// Write the hull of a recording's frames as a closed triangle mesh, PLY or OBJ, in metres.
///
/// Triangles are counter-clockwise as seen from outside, vertices have outward normals. With --frames the number of the
/// frame is added to the file name: hull.ply becomes hull_000000.ply and so on.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// Folder of a recording with masks.
    recording: PathBuf,
    /// Frame to convert [default: the first].
    #[arg(long, value_name = "N", conflicts_with = "frames")]
    frame: Option<u32>,
    /// Frames to convert, from A to before B; either may be left out.
    #[arg(long, value_name = "A..B", value_parser = parse_frames)]
    frames: Option<std::ops::Range<u32>>,
    /// Edge length of the grid cells, in metres.
    #[arg(long, value_name = "METRES", default_value = "0.01", value_parser = parse_length)]
    resolution: f64,
    /// File to write; its name ends in .ply (binary) or .obj. Its folder is created if missing.
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    volume: VolumeOptions,
}

const EXAMPLES: &str = "\
Examples:
  vhull mesh my_recording -o hull.ply
  vhull mesh my_recording --frames 0..100 --resolution 0.02 -o meshes/hull.obj";

/// File format of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Ply,
    Obj,
}

pub fn run(options: &Options) -> Result<Outcome> {
    // Refuse what can be refused before any hull is built.
    let format = format_of(&options.out)?;
    let recording = open_recording(&options.recording)?;
    let recorded = RecordedHulls::new(recording, &options.recording, &options.volume)?;
    let frames = frames(options, &recorded)?;
    make_folder_of(&options.out)?;

    let bar = progress::bar(frames.len(), "meshes");
    for &frame in &frames {
        let hull = recorded.hull(frame)?;
        let surface = Surface::of(&SignedField::of(&hull, options.resolution)?);
        if surface.triangles.is_empty() {
            let problem = format!(
                "expected a subject in frame {frame}, found a hull without points at {} m; take a finer \
                 --resolution, or look for the cause with vhull check",
                options.resolution
            );
            return Err(Error::file(&options.recording, problem));
        }

        let path = if options.frames.is_some() { numbered(&options.out, frame) } else { options.out.clone() };
        let bytes = match format {
            Format::Ply => surface.to_ply(),
            Format::Obj => surface.to_obj().into_bytes(),
        };
        std::fs::write(&path, bytes)
            .map_err(|e| Error::file(&path, format!("expected to write a mesh, found: {e}")))?;

        bar.suspend(|| {
            println!(
                "{}: {} vertices, {} triangles, {}",
                path.display(),
                surface.points.len(),
                surface.triangles.len(),
                shown_volume(surface.volume())
            );
        });
        bar.inc(1);
    }

    bar.finish_and_clear();
    Ok(Outcome::Done)
}

/// Formats a volume: cubic centimetres below 10 litres, else cubic metres.
fn shown_volume(volume: f64) -> String {
    if volume.abs() < 0.01 { format!("{:.1} cm3", 1e6 * volume) } else { format!("{volume:.4} m3") }
}

/// The format that the extension of `path` names.
fn format_of(path: &Path) -> Result<Format> {
    match path.extension().map(|extension| extension.to_ascii_lowercase()) {
        Some(extension) if extension == "ply" => Ok(Format::Ply),
        Some(extension) if extension == "obj" => Ok(Format::Obj),
        _ => Err(Error::file(path, "expected a name that ends in .ply or .obj, found another; rename it")),
    }
}

/// Numbers of the frames to convert; at least one.
fn frames(options: &Options, recorded: &RecordedHulls) -> Result<Vec<u32>> {
    let all = recorded.recording.frames();
    let Some(range) = &options.frames else {
        // A frame without masks is refused when these are read.
        return Ok(vec![options.frame.unwrap_or(all[0])]);
    };

    let frames: Vec<u32> = all.iter().copied().filter(|frame| range.contains(frame)).collect();
    if frames.is_empty() {
        let (first, last) = (all[0], all[all.len() - 1]);
        return Err(Error::argument(format!(
            "--frames: expected some of frames {first} to {last}, found {}",
            shown_frames(range)
        )));
    }
    Ok(frames)
}

/// Adds the frame's number to a file name: `hull.ply` of frame 7 becomes `hull_000007.ply`.
fn numbered(path: &Path, frame: u32) -> PathBuf {
    let mut name = OsString::from(path.file_stem().unwrap_or_default());
    name.push(format!("_{frame:06}."));
    name.push(path.extension().unwrap_or_default());
    path.with_file_name(name)
}
