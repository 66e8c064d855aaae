//! Writer of the file.

use super::{BodiesFile, playback};
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::shape::Shape;
use ode_visual_hull::{Error, Result};
use std::fmt::Write;

pub(super) fn write(file: &BodiesFile) -> Result<String> {
    let mut text = String::from(
        "# The bodies of a run, in the order of states.csv. Metres; quaternions are w, x, y, z.\n",
    );
    for (i, parts) in file.bodies.iter().enumerate() {
        if parts.is_empty() {
            let problem =
                format!("body {}: expected a part at least, found none; leave it out, or add one", i + 1);
            return Err(Error::argument(problem));
        }
        text += "\n[[body]]\n";
        for (k, part) in parts.iter().enumerate() {
            let shape = shape(&part.shape)
                .map_err(|e| Error::argument(format!("body {}, part {}: {e}", i + 1, k + 1)))?;
            let _ = write!(text, "\n[[body.part]]\n{shape}{}", look(part.colour, &part.body_from_part));
        }
    }

    for (i, part) in file.fixed.iter().enumerate() {
        let shape = shape(&part.shape).map_err(|e| Error::argument(format!("fixed part {}: {e}", i + 1)))?;
        let _ = write!(text, "\n[[fixed]]\n{shape}{}", look(part.colour, &part.world_from_body));
    }
    if let Some(played) = &file.playback {
        let _ = write!(text, "\n{}", playback::write(played));
    }
    Ok(text)
}

fn look(colour: [u8; 3], pose: &Isometry3<f64>) -> String {
    let (p, q) = (pose.translation, pose.rotation);
    format!(
        "colour = {colour:?}\nposition = {:?}\nquaternion = {:?}\n",
        [p.x, p.y, p.z],
        [q.w, q.i, q.j, q.k]
    )
}

/// The fields of a shape. The debug form of a float is the shortest text that reads back to the same bits, and valid TOML.
fn shape(shape: &Shape) -> Result<String> {
    let text = match shape {
        Shape::Box { sides } => format!("shape = \"box\"\nsides = {:?}\n", [sides.x, sides.y, sides.z]),
        Shape::Sphere { radius } => format!("shape = \"sphere\"\nradius = {radius:?}\n"),
        Shape::Capsule { radius, length } => {
            format!("shape = \"capsule\"\nradius = {radius:?}\nlength = {length:?}\n")
        }
        Shape::Cylinder { radius, length } => {
            format!("shape = \"cylinder\"\nradius = {radius:?}\nlength = {length:?}\n")
        }
        Shape::Plane { normal, offset } => {
            format!("shape = \"plane\"\nnormal = {:?}\noffset = {offset:?}\n", [normal.x, normal.y, normal.z])
        }
        Shape::Convex(convex) => {
            let faces: Vec<_> = convex.faces().collect();
            format!("shape = \"convex\"\npoints = {:?}\nfaces = {faces:?}\n", rows(convex.points()))
        }
        Shape::TriMesh(mesh) => {
            let (points, triangles) = (rows(mesh.points()), mesh.triangles());
            format!("shape = \"trimesh\"\npoints = {points:?}\ntriangles = {triangles:?}\n")
        }
        Shape::Heightfield(field) => format!(
            "shape = \"heightfield\"\ncounts = {:?}\nsize = {:?}\nheights = {:?}\nthickness = {:?}\nwraps = {}\n",
            field.counts(),
            field.size(),
            field.heights(),
            field.thickness(),
            field.wraps()
        ),
        other => {
            let problem = format!("expected a shape that is drawn, found {other:?}; leave it out");
            return Err(Error::argument(problem));
        }
    };
    Ok(text)
}

fn rows(points: &[Point3<f64>]) -> Vec<[f64; 3]> {
    points.iter().map(|point| [point.x, point.y, point.z]).collect()
}
