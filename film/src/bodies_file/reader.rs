//! Reader of the whole file.

use super::table::{Table, line_of};
use super::{BodiesFile, DrawnPart, playback, shapes};
use crate::compositor::Drawn;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use ode_visual_hull::{Error, Result};
use toml::de::DeTable;

/// Fields of every part.
const PART: [&str; 4] = ["shape", "colour", "position", "quaternion"];

pub(super) fn read(text: &str) -> Result<BodiesFile> {
    let document = DeTable::parse(text).map_err(|e| {
        let line = e.span().map_or(1, |span| line_of(text, span.start));
        Error::argument(format!("line {line}: expected TOML, found: {}", e.message()))
    })?;

    let file = Table::of_file(text, document.get_ref());
    file.check_fields(&["body", "fixed", "playback"])?;
    let of_fixed = |part: DrawnPart| part.at(&Isometry3::identity());
    Ok(BodiesFile {
        bodies: file.tables("body", "body")?.iter().map(body).collect::<Result<_>>()?,
        fixed: file
            .tables("fixed", "fixed part")?
            .iter()
            .map(|table| part(table).map(of_fixed))
            .collect::<Result<Vec<Drawn>>>()?,
        playback: file.table("playback")?.map(|table| playback::read(&table)).transpose()?,
    })
}

/// The parts of a body; at least one.
fn body(table: &Table) -> Result<Vec<DrawnPart>> {
    table.check_fields(&["part"])?;
    let parts = table.tables("part", "part")?;
    if parts.is_empty() {
        return Err(table.refuse(
            "part",
            "a part at least, found none",
            "describe each part under [[body.part]]",
        ));
    }
    parts.iter().map(part).collect()
}

fn part(table: &Table) -> Result<DrawnPart> {
    let kind = shapes::kind(table)?;
    table.check_fields(&[&PART[..], kind.fields].concat())?;
    let shape = (kind.read)(table)?;
    let colour = table.whole_numbers("colour", "write red, green and blue from 0 to 255")?;
    Ok(DrawnPart { shape, body_from_part: pose(table)?, colour })
}

fn pose(table: &Table) -> Result<Isometry3<f64>> {
    let position = table.numbers("position", "write x, y and z in metres")?;
    let next = "write w, x, y, z, as [1.0, 0.0, 0.0, 0.0] for none";
    let [w, x, y, z] = table.numbers("quaternion", next)?;
    let turn = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
        .ok_or_else(|| table.refuse("quaternion", "a rotation, found a quaternion of length 0", next))?;
    Ok(Isometry3::from_parts(Translation3::from(position), turn))
}
