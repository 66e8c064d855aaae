//! What the cameras' places tell: whether they look at one spot, what of the work volume they see, the tent.

use super::{Options, Report, Table};
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::rig::{PoseConvention, Rig};
use ode_visual_hull::synthetic::Tent;

/// Points along the work volume's longest side at which it is asked who sees them.
const FINENESS: usize = 48;

/// A tent that is higher than this share of the table's size is worth a word of advice.
const HIGH: f64 = 0.05;

/// Tells of the cameras' places; true if silhouettes can be compared: there is a work volume, and all see some of it.
pub fn describe_rig(rig: &Rig, options: &Options, report: &mut Report) -> Result<bool> {
    match rig.focus() {
        Ok(focus) => spot(rig, &focus, report)?,
        Err(error) => report.add_problem(error.to_string()),
    }
    let has_volume = options.volume.bounds.is_some() || rig.work_volume().is_ok();
    let all_see = has_volume && volume(rig, options, report)?;
    options.table.iter().try_for_each(|table| tent(rig, table, report))?;
    Ok(all_see)
}

/// The place that all look at.
fn spot(rig: &Rig, focus: &Point3<f64>, report: &mut Report) -> Result<()> {
    let miss = |camera: &Camera| (focus - camera.centre()).cross(&camera.forward()).norm();
    println!("they look at {}, each axis passing it by", place(focus));
    for camera in rig.cameras() {
        let distance = (focus - camera.centre()).norm();
        println!("  {}: {:.2} m at a distance of {distance:.2} m", camera.name(), miss(camera));
    }
    let seeing = rig.seeing_focus()?;
    if seeing.len() == rig.len() {
        return Ok(());
    }
    let blind: Vec<_> = (0..rig.len()).filter(|k| !seeing.contains(k)).collect();
    let names: Vec<_> = blind.iter().map(|&k| rig.cameras()[k].name()).collect();
    let behind =
        blind.iter().all(|&k| (focus - rig.cameras()[k].centre()).dot(&rig.cameras()[k].forward()) < 0.0);
    let how = if behind { "is behind" } else { "is outside the image of" };
    let better = PoseConvention::ALL.into_iter().find(|&reading| sees_more(rig, reading, seeing.len()));
    let advice = match better {
        Some(reading) => format!("with {}, all see one spot: convert the poses so", reading.describe()),
        None => "turn the camera, or check its pose".to_owned(),
    };
    report.add_problem(format!("the spot that the cameras look at {how} {}; {advice}", names.join(", ")));
    Ok(())
}

/// Whether with another reading all cameras see one spot.
fn sees_more(rig: &Rig, reading: PoseConvention, than: usize) -> bool {
    let seeing = rig.read_as(reading).and_then(|rig| rig.seeing_focus());
    seeing.is_ok_and(|seeing| seeing.len() == rig.len() && seeing.len() > than)
}

/// How much of the work volume is seen by how many; true if every camera sees some.
fn volume(rig: &Rig, options: &Options, report: &mut Report) -> Result<bool> {
    let volume = options.volume.of(rig)?;
    println!("work volume {} to {}", place(&volume.min), place(&volume.max));
    let shares = rig.coverage(&volume, FINENESS);
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    // What would read "0 %" is left out.
    let counted = shares.iter().enumerate().filter(|(_, share)| **share >= 0.005);
    let counted: Vec<_> = counted.map(|(n, &share)| format!("{} by {n}", percent(share))).collect();
    println!("  seen by so many cameras: {}", counted.join(", "));
    let of: Vec<f64> = rig.cameras().iter().map(|c| Rig::coverage_of(c, &volume, FINENESS)).collect();
    let named = rig.cameras().iter().zip(&of);
    let told: Vec<_> =
        named.clone().map(|(c, &share)| format!("{} by {}", percent(share), c.name())).collect();
    println!("  seen by each: {}", told.join(", "));
    let blind: Vec<_> = named.filter(|(_, share)| **share == 0.0).map(|(c, _)| c.name()).collect();
    if !blind.is_empty() {
        report.add_problem(format!(
            "nothing of the work volume is seen by {}; give --bounds around the subject, or check the poses",
            blind.join(", ")
        ));
    } else if shares.iter().skip(2).sum::<f64>() == 0.0 && rig.len() > 1 {
        report.add_problem(
            "no part of the work volume is seen by two cameras; give --bounds around the subject, or check the poses",
        );
    }
    Ok(blind.is_empty())
}

/// The hull above a table.
fn tent(rig: &Rig, table: &Table, report: &mut Report) -> Result<()> {
    let Table { top, side } = *table;
    let tent = Tent::above(rig.cameras(), top, side)?;
    let name = format!("above a table of {side} m at {}", place(&top));
    if tent.cameras.len() < 2 {
        report.add_problem(format!(
            "{name}: expected at least two cameras that see its top, found {}; move them, or the table",
            tent.cameras.len()
        ));
        return Ok(());
    }
    println!(
        "{name} the hull rises {:.0} mm in the middle, {:.0} mm at most, by the {} cameras that see its top",
        1e3 * tent.middle,
        1e3 * tent.highest,
        tent.cameras.len()
    );
    let above = |&k: &usize| {
        let camera = &rig.cameras()[k];
        let up = camera.centre() - top;
        (up.z.atan2(up.xy().norm()).to_degrees(), camera.name())
    };
    let lowest = tent.cameras.iter().map(above).filter(|(degrees, _)| *degrees >= 0.0);
    let lowest = lowest.min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((degrees, name)) = lowest.filter(|_| tent.highest > HIGH * side) {
        println!(
            "  the camera that looks along it most is {name}, {degrees:.0} degrees above; one at a height of {:.2} m \
             would flatten it",
            top.z
        );
    }
    Ok(())
}

fn place(p: &Point3<f64>) -> String {
    format!("({:.2}, {:.2}, {:.2}) m", p.x, p.y, p.z)
}
