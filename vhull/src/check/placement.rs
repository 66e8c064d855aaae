//! Checks of the cameras' poses: whether they look at one point, how much of the work volume they see, and how high the
//! hull rises above a table.

use super::{Options, Report, Table};
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::rig::{PoseConvention, Rig};
use ode_visual_hull::synthetic::Tent;

/// Sample points along the longest side of the work volume.
const FINENESS: usize = 48;

/// Height of the hull above a table, as a fraction of the table's size, from which on advice is printed.
const ADVICE_HEIGHT: f64 = 0.05;

/// Describes the cameras' poses. Returns whether silhouettes can be compared: there is a work volume, and every camera
/// sees some of it.
pub fn describe_rig(rig: &Rig, options: &Options, report: &mut Report) -> Result<bool> {
    match rig.focus() {
        Ok(focus) => describe_focus(rig, &focus, report)?,
        Err(error) => report.add_problem(error.to_string()),
    }
    let has_volume = options.volume.bounds.is_some() || rig.work_volume().is_ok();
    let all_see = has_volume && describe_volume(rig, options, report)?;
    options.table.iter().try_for_each(|table| describe_tent(rig, table, report))?;
    Ok(all_see)
}

/// The point nearest to all optical axes, and the cameras that do not see it.
fn describe_focus(rig: &Rig, focus: &Point3<f64>, report: &mut Report) -> Result<()> {
    let miss = |camera: &Camera| (focus - camera.centre()).cross(&camera.forward()).norm();
    println!("the cameras look at {}; distance of each optical axis from it:", place(focus));
    for camera in rig.cameras() {
        let distance = (focus - camera.centre()).norm();
        println!("  {}: {:.2} m, seen from {distance:.2} m", camera.name(), miss(camera));
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

    // Poses in another convention are a common cause: does one of them make all cameras see the point?
    let better = PoseConvention::ALL.into_iter().find(|&convention| sees_more(rig, convention, seeing.len()));
    let advice = match better {
        Some(convention) => {
            format!(
                "with {}, all cameras see one point: convert the poses in this way",
                convention.describe()
            )
        }
        None => "turn the camera, or check its pose".to_owned(),
    };
    report.add_problem(format!("the point that the cameras look at {how} {}; {advice}", names.join(", ")));
    Ok(())
}

/// Whether all cameras, and more than `than`, see the focus if the poses are read in another convention.
fn sees_more(rig: &Rig, convention: PoseConvention, than: usize) -> bool {
    let seeing = rig.read_as(convention).and_then(|rig| rig.seeing_focus());
    seeing.is_ok_and(|seeing| seeing.len() == rig.len() && seeing.len() > than)
}

/// Shares of the work volume by the number of cameras that see them, and by camera. Returns whether every camera sees
/// some of it.
fn describe_volume(rig: &Rig, options: &Options, report: &mut Report) -> Result<bool> {
    let volume = options.volume.of(rig)?;
    println!("work volume {} to {}", place(&volume.min), place(&volume.max));

    let shares = rig.coverage(&volume, FINENESS);
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    // Shares that would be printed as "0 %" are left out.
    let counted = shares.iter().enumerate().filter(|(_, share)| **share >= 0.005);
    let counted: Vec<_> = counted.map(|(n, &share)| format!("{} by {n}", percent(share))).collect();
    println!("  seen by this many cameras: {}", counted.join(", "));

    let own_shares = rig.cameras().iter().map(|c| Rig::coverage_of(c, &volume, FINENESS));
    let own_shares: Vec<f64> = own_shares.collect();
    let named = rig.cameras().iter().zip(&own_shares);
    let listed: Vec<_> =
        named.clone().map(|(c, &share)| format!("{} by {}", percent(share), c.name())).collect();
    println!("  seen by each: {}", listed.join(", "));

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

/// The height of the hull above a table, and how to lower it.
fn describe_tent(rig: &Rig, table: &Table, report: &mut Report) -> Result<()> {
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

    // The camera with the lowest line of sight bounds the hull best: one at the height of the top would flatten it.
    let elevation = |&k: &usize| {
        let camera = &rig.cameras()[k];
        let up = camera.centre() - top;
        (up.z.atan2(up.xy().norm()).to_degrees(), camera.name())
    };
    let lowest = tent.cameras.iter().map(elevation).filter(|(degrees, _)| *degrees >= 0.0);
    let lowest = lowest.min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((degrees, name)) = lowest.filter(|_| tent.highest > ADVICE_HEIGHT * side) {
        println!(
            "  the lowest line of sight is that of {name}, {degrees:.0} degrees above the top; a camera at a height of \
             {:.2} m would flatten the hull",
            top.z
        );
    }
    Ok(())
}

/// Formats a point in metres.
fn place(p: &Point3<f64>) -> String {
    format!("({:.2}, {:.2}, {:.2}) m", p.x, p.y, p.z)
}
