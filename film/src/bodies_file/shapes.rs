//! Reader of the shapes.

use super::table::Table;
use nalgebra::{Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::shape::{Convex, Heightfield, Shape, TriMesh};
use std::sync::Arc;

/// A kind of shape.
pub(super) struct Kind {
    /// Its name in the file.
    pub(super) name: &'static str,
    /// The fields of its own.
    pub(super) fields: &'static [&'static str],
    pub(super) read: fn(&Table) -> Result<Shape>,
}

const KINDS: [Kind; 8] = [
    Kind { name: "box", fields: &["sides"], read: cuboid },
    Kind { name: "sphere", fields: &["radius"], read: sphere },
    Kind { name: "capsule", fields: &["radius", "length"], read: capsule },
    Kind { name: "cylinder", fields: &["radius", "length"], read: cylinder },
    Kind { name: "plane", fields: &["normal", "offset"], read: plane },
    Kind { name: "convex", fields: &["points", "faces"], read: convex },
    Kind { name: "trimesh", fields: &["points", "triangles"], read: trimesh },
    Kind {
        name: "heightfield",
        fields: &["counts", "size", "heights", "thickness", "wraps"],
        read: heightfield,
    },
];

const POINTS: &str = "write each point as [x, y, z] in metres";

/// The kind of shape that a part has.
pub(super) fn kind(table: &Table) -> Result<&'static Kind> {
    let next = "name one of these shapes";
    let name = table.word("shape", "name the shape of the part, as shape = \"box\"")?;
    KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| {
        let found = if name == "ray" { "a ray, which is not drawn".into() } else { format!("\"{name}\"") };
        let names: Vec<_> = KINDS.iter().map(|kind| kind.name).collect();
        table.refuse("shape", format!("one of {}, found {found}", names.join(", ")), next)
    })
}

fn cuboid(table: &Table) -> Result<Shape> {
    Ok(Shape::Box { sides: Vector3::from(table.lengths("sides")?) })
}

fn sphere(table: &Table) -> Result<Shape> {
    Ok(Shape::Sphere { radius: table.length("radius")? })
}

fn capsule(table: &Table) -> Result<Shape> {
    Ok(Shape::Capsule { radius: table.length("radius")?, length: table.length("length")? })
}

fn cylinder(table: &Table) -> Result<Shape> {
    Ok(Shape::Cylinder { radius: table.length("radius")?, length: table.length("length")? })
}

fn plane(table: &Table) -> Result<Shape> {
    let next = "write the direction to the free side";
    let normal = Vector3::from(table.numbers("normal", next)?);
    if normal.norm() < 1e-6 {
        return Err(table.refuse("normal", "a direction, found a vector of length 0", next));
    }
    Ok(Shape::Plane {
        normal,
        offset: table.number("offset", "write the distance from the origin in metres")?,
    })
}

fn convex(table: &Table) -> Result<Shape> {
    let faces = table.index_rows("faces", "write each face as the indices of its points")?;
    let convex = Convex::new(points(table)?, &faces).map_err(|e| table.problem("faces", e))?;
    Ok(Shape::Convex(Arc::new(convex)))
}

fn trimesh(table: &Table) -> Result<Shape> {
    let next = "write each triangle as the indices of three points";
    let triangle = |indices: Vec<u32>| {
        let count = indices.len();
        indices
            .try_into()
            .map_err(|_| table.refuse("triangles", format!("3 indices each, found {count}"), next))
    };
    let triangles = table.index_rows("triangles", next)?.into_iter().map(triangle).collect::<Result<_>>()?;
    let mesh = TriMesh::new(points(table)?, triangles).map_err(|e| table.problem("triangles", e))?;
    Ok(Shape::TriMesh(Arc::new(mesh)))
}

fn points(table: &Table) -> Result<Vec<Point3<f64>>> {
    Ok(table.rows("points", POINTS)?.into_iter().map(Point3::from).collect())
}

fn heightfield(table: &Table) -> Result<Shape> {
    let counts = table.whole_numbers("counts", "write the number of columns and of rows")?;
    let heights = table.list("heights", "write the heights row by row, in metres")?;
    let field =
        Heightfield::new(heights, counts, table.lengths("size")?).map_err(|e| table.problem("heights", e))?;
    let thickness = table.number("thickness", "write it in metres, 0.0 for none")?;
    let field = field.with_thickness(thickness).map_err(|e| table.problem("thickness", e))?;
    let wraps = table.flag("wraps", "write whether the ground repeats endlessly")?;
    Ok(Shape::Heightfield(Arc::new(if wraps { field.wrapped() } else { field })))
}
