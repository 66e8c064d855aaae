//! Whether a recording's silhouettes belong to one subject: shifts, cuts, and why a hull is empty.

use super::{Options, Report};
use crate::progress;
use crate::recorded_hulls::RecordedHulls;
use ode_visual_hull::Result;
use ode_visual_hull::hull::{EmptyReason, Hull, HullData};
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::rig::{PoseConvention, Rig};
use ode_visual_hull_check::{
    EpipolarTangency, SilhouetteCoherence, ViewShift, silhouette_coherence, total_coherence,
};

/// Every so many pixels and rows a ray is asked whether it meets the hull.
const STEP: usize = 4;

/// So many of the frames are asked pixel by pixel.
const FITTED: usize = 8;

/// Planes that have to speak of a view before its shift is believed.
const FEW_PLANES: usize = 4;

/// Undoing a shift has to lessen the gaps by this share of the tolerance: of some shifts the pairs of cameras tell little.
const LEAST_GAIN: f64 = 0.1;

/// A view of whose silhouettes the hull fills less than this share has something wrong with it or with the others.
const LEAST_FILLED: f64 = 0.75;

pub fn describe_silhouettes(recorded: &RecordedHulls, options: &Options, report: &mut Report) -> Result<()> {
    let frames = match (options.frames, options.frame) {
        (1, Some(frame)) => vec![frame],
        (most, _) => recorded.spread_frames(most as usize),
    };
    let (mut tangents, mut fits, mut empty) = (EpipolarTangency::new(), Vec::new(), Vec::new());
    let bar = progress::bar(frames.len(), "silhouettes");
    let fitted = frames.len().div_ceil(FITTED);
    for (k, &frame) in frames.iter().enumerate() {
        let hull = recorded.hull(frame)?;
        tangents.add(&hull);
        if k % fitted == 0 {
            let of_frame = silhouette_coherence(&hull, STEP);
            if of_frame.iter().all(|fit| fit.filled_pixels == 0) {
                empty.push((frame, hull.clone()));
            }
            fits.push(of_frame);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    println!("silhouettes of {} frames, {} to {}", frames.len(), frames[0], frames[frames.len() - 1]);
    let shifts = tangents.shifts();
    let fits = total_coherence(&fits);
    table(recorded.recording.rig(), &shifts, &fits);
    judge(recorded.recording.rig(), &shifts, &fits, options, report);
    if let Some((frame, hull)) = empty.first() {
        report.add_problem(format!("frame {frame}: the hull is empty: {}", why(hull, recorded, *frame)?));
    }
    Ok(())
}

fn table(rig: &Rig, shifts: &[ViewShift], fits: &[SilhouetteCoherence]) {
    let width = rig.cameras().iter().map(|camera| camera.name().chars().count()).max().unwrap_or(0).max(6);
    let all: usize = fits.iter().map(|fit| fit.pixels).sum();
    println!(
        "  {:width$}  {:>16}  {:>7}  {:>11}  {:>6}  {:>22}",
        "camera", "shifted by, px", "gain", "gap", "filled", "cuts away"
    );
    for ((camera, shift), fit) in rig.cameras().iter().zip(shifts).zip(fits) {
        let by = match shift.planes {
            0 => "unknown".into(),
            _ => format!("({:.1}, {:.1})", tenths(-shift.shift.x), tenths(-shift.shift.y)),
        };
        let cuts = match fit.carved_pixels {
            0 => "nothing".into(),
            cuts => format!("{:.1} %, {:.0} px deep", 100.0 * cuts as f64 / all as f64, fit.carved_depth_px),
        };
        println!(
            "  {:width$}  {by:>16}  {:>4.1} px  {:>11}  {:>4.0} %  {cuts:>22}",
            camera.name(),
            tenths(shift.gain),
            format!("{:.1}, {:.1} px", shift.gap, shift.gap_after),
            100.0 * fit.filled_share(),
        );
    }
    println!(
        "  shifted by: right and down, against what the others see; gain: by how much undoing it lessens gaps\n  \
         gap: at the outermost planes shared with other views, the median, as it is and after all shifts are undone\n  \
         filled: of its silhouettes by the hull; cuts away: of all silhouettes what this view alone denies, and how \
         deep"
    );
}

/// Rounded, and no minus before a zero.
fn tenths(x: f64) -> f64 {
    (10.0 * x).round() / 10.0 + 0.0
}

fn judge(
    rig: &Rig,
    shifts: &[ViewShift],
    fits: &[SilhouetteCoherence],
    options: &Options,
    report: &mut Report,
) {
    let off = |shift: &ViewShift| {
        shift.planes >= FEW_PLANES
            && shift.shift.norm() > options.tolerance
            && shift.gain > LEAST_GAIN * options.tolerance
    };
    let mut off_views: Vec<usize> = (0..shifts.len()).filter(|&k| off(&shifts[k])).collect();
    off_views.sort_by(|&a, &b| shifts[b].shift.norm().total_cmp(&shifts[a].shift.norm()));
    if rig.len() < 3 && !off_views.is_empty() {
        let gap = shifts.iter().map(|shift| shift.gap).fold(0.0, f64::max);
        report.add_problem(format!(
            "the two views' silhouettes miss each other by {gap:.1} px; two views do not tell which is off: calibrate \
             both again"
        ));
        return;
    }
    for &k in &off_views {
        let s = -shifts[k].shift;
        report.add_problem(format!(
            "{}: its silhouettes lie {:.1} px off, by ({:.1}, {:.1}) px right and down, more than {} px; calibrate it \
             again, or move its principal point by as much",
            rig.cameras()[k].name(),
            s.norm(),
            s.x,
            s.y,
            options.tolerance
        ));
    }
    if !off_views.is_empty() {
        return;
    }
    for (camera, fit) in rig.cameras().iter().zip(fits).filter(|(_, fit)| fit.filled_share() < LEAST_FILLED) {
        let worst =
            (0..fits.len()).max_by_key(|&k| fits[k].carved_pixels).filter(|&k| fits[k].carved_pixels > 0);
        let by = worst.map_or(String::new(), |k| format!("; {} cuts most", rig.cameras()[k].name()));
        report.add_problem(format!(
            "{}: the hull fills only {:.0} % of its silhouettes{by}: check the masks (--pictures), the work volume and \
             --unseen",
            camera.name(),
            100.0 * fit.filled_share()
        ));
    }
}

/// Why a frame's hull is empty, and what would fill it.
fn why(hull: &Hull, recorded: &RecordedHulls, frame: u32) -> Result<String> {
    let name = |view: usize| hull.views()[view].name().to_owned();
    let reason = match hull.empty_reason() {
        Some(EmptyReason::NoViews) => "no view takes part".into(),
        Some(EmptyReason::EmptySilhouette { view }) => format!("the mask of {} holds no subject", name(view)),
        Some(EmptyReason::NothingInCommon { view }) => format!(
            "what {} sees has no point in common with the work volume and the views before it",
            name(view)
        ),
        None => "no point is subject in all views".into(),
    };
    for reading in PoseConvention::ALL {
        if recorded
            .recording
            .rig()
            .read_as(reading)
            .and_then(|rig| fills(&rig, recorded, frame))
            .unwrap_or(false)
        {
            return Ok(format!("{reason}; with {} it is not: convert the poses so", reading.describe()));
        }
    }
    Ok(format!(
        "{reason}; give --bounds around the subject, or --unseen abstain where no point is in sight of all"
    ))
}

/// Whether a frame's hull by another rig holds anything.
fn fills(rig: &Rig, recorded: &RecordedHulls, frame: u32) -> Result<bool> {
    let data = HullData::new();
    data.add_views(rig.cameras())?;
    data.set_bounds(rig.work_volume()?)?;
    let hull = publish_masks(&data, &recorded.recording.masks(frame)?, 0.0)?;
    Ok(silhouette_coherence(&hull, 2 * STEP).iter().any(|fit| fit.filled_pixels > 0))
}
