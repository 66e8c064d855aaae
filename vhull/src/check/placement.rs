//! What follows from the cameras' poses: whether they look at one spot, how much of the work volume they see, and the
//! height of the tent above a table.

use super::{Options, Report, Table};
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::rig::{PoseConvention, Rig};
use ode_visual_hull::synthetic::Tent;

/// Number of sample points along the longest side of the work volume.
const SAMPLES: usize = 48;

/// Height of a tent, as a share of the table's size, from which on advice is given.
const HIGH_TENT: f64 = 0.05;

/// Prints where the cameras are and what they see. Returns whether silhouettes can be compared: there is a work volume,
/// and all cameras see some of it.
pub fn describe_rig(rig: &Rig, options: &Options, report: &mut Report) -> Result<bool> {
    match rig.focus() {
        Ok(focus) => focus_spot(rig, &focus, report)?,
        Err(error) => report.add_problem(error.to_string()),
    }
    let has_volume = options.volume.bounds.is_some() || rig.work_volume().is_ok();
    let all_see = has_volume && volume(rig, options, report)?;
    options.table.iter().try_for_each(|table| tent(rig, table, report))?;
    Ok(all_see)
}

/// Prints the spot that all cameras look at, and how well they do.
fn focus_spot(rig: &Rig, focus: &Point3<f64>, report: &mut Report) -> Result<()> {
    let miss = |camera: &Camera| (focus - camera.centre()).cross(&camera.forward()).norm();
    println!("they look at {}; distance of each axis from it", metres(focus));
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
    let better = PoseConvention::ALL.into_iter().find(|&poses| sees_more(rig, poses, seeing.len()));
    let advice = match better {
        Some(poses) => format!("with {}, all see one spot: convert the poses so", poses.describe()),
        None => "turn the camera, or check its pose".to_owned(),
    };
    report.add_problem(format!("the spot that the cameras look at {how} {}; {advice}", names.join(", ")));

    Ok(())
}

/// Whether all cameras see one spot by another convention of poses, and more than `than` of them.
fn sees_more(rig: &Rig, poses: PoseConvention, than: usize) -> bool {
    let seeing = rig.read_as(poses).and_then(|rig| rig.seeing_focus());
    seeing.is_ok_and(|seeing| seeing.len() == rig.len() && seeing.len() > than)
}

/// Prints how much of the work volume is seen, by how many cameras and by each. Returns whether each sees some of it.
fn volume(rig: &Rig, options: &Options, report: &mut Report) -> Result<bool> {
    let volume = options.volume.of(rig)?;
    println!("work volume {} to {}", metres(&volume.min), metres(&volume.max));
    let shares = rig.coverage(&volume, SAMPLES);
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);

    // Shares that round to 0 % are left out.
    let counted = shares.iter().enumerate().filter(|(_, share)| **share >= 0.005);
    let counted: Vec<_> = counted.map(|(n, &share)| format!("{} by {n}", percent(share))).collect();
    println!("  seen by so many cameras: {}", counted.join(", "));
    let of: Vec<f64> = rig.cameras().iter().map(|c| Rig::coverage_of(c, &volume, SAMPLES)).collect();
    let named = rig.cameras().iter().zip(&of);
    let each: Vec<_> =
        named.clone().map(|(c, &share)| format!("{} by {}", percent(share), c.name())).collect();
    println!("  seen by each: {}", each.join(", "));
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

/// Prints how high the hull rises above a table.
fn tent(rig: &Rig, table: &Table, report: &mut Report) -> Result<()> {
    let Table { top, side } = *table;
    let tent = Tent::above(rig.cameras(), top, side)?;
    let name = format!("above a table of {side} m at {}", metres(&top));

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

    if let Some((degrees, name)) = lowest.filter(|_| tent.highest > HIGH_TENT * side) {
        println!(
            "  the camera that looks along it most is {name}, {degrees:.0} degrees above; one at a height of {:.2} m \
             would flatten it",
            top.z
        );
    }

    Ok(())
}

fn metres(p: &Point3<f64>) -> String {
    format!("({:.2}, {:.2}, {:.2}) m", p.x, p.y, p.z)
}
