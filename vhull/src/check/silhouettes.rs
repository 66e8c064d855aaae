//! Whether a recording's silhouettes fit one another: shifted views, views that cut, and why a hull is empty.

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

/// Distance of the pixels, in columns and in rows, whose viewing rays are tested against the hull.
const STEP: usize = 4;

/// Number of frames whose coherence is measured, pixel by pixel.
const COHERENCE_FRAMES: usize = 8;

/// Least number of tangent planes for a shift to count.
const MIN_PLANES: usize = 4;

/// Share of the tolerance by which undoing a shift has to lessen the gaps. Pairs of cameras determine some shifts badly.
const MIN_GAIN: f64 = 0.1;

/// The hull fills less than this share of a view's silhouettes: the view or the others are wrong.
const MIN_FILLED: f64 = 0.75;

/// Prints how the silhouettes of each view fit the others', and adds problems to the report.
pub fn describe_silhouettes(recorded: &RecordedHulls, options: &Options, report: &mut Report) -> Result<()> {
    let frames = match (options.frames, options.frame) {
        (1, Some(frame)) => vec![frame],
        (most, _) => recorded.spread_frames(most as usize),
    };
    let (mut tangency, mut coherence, mut empty) = (EpipolarTangency::new(), Vec::new(), Vec::new());
    let bar = progress::bar(frames.len(), "silhouettes");
    let every = frames.len().div_ceil(COHERENCE_FRAMES);

    for (k, &frame) in frames.iter().enumerate() {
        let hull = recorded.hull(frame)?;
        tangency.add(&hull);
        if k % every == 0 {
            let of_frame = silhouette_coherence(&hull, STEP);
            if of_frame.iter().all(|view| view.filled_pixels == 0) {
                empty.push((frame, hull.clone()));
            }
            coherence.push(of_frame);
        }
        bar.inc(1);
    }

    bar.finish_and_clear();
    println!("silhouettes of {} frames, {} to {}", frames.len(), frames[0], frames[frames.len() - 1]);
    let shifts = tangency.shifts();
    let coherence = total_coherence(&coherence);
    print_table(recorded.recording.rig(), &shifts, &coherence);
    add_problems(recorded.recording.rig(), &shifts, &coherence, options, report);
    if let Some((frame, hull)) = empty.first() {
        report
            .add_problem(format!("frame {frame}: the hull is empty: {}", why_empty(hull, recorded, *frame)?));
    }

    Ok(())
}

fn print_table(rig: &Rig, shifts: &[ViewShift], coherence: &[SilhouetteCoherence]) {
    let width = rig.cameras().iter().map(|camera| camera.name().chars().count()).max().unwrap_or(0).max(6);
    let all: usize = coherence.iter().map(|view| view.pixels).sum();
    println!(
        "  {:width$}  {:>16}  {:>7}  {:>11}  {:>6}  {:>22}",
        "camera", "shifted by, px", "gain", "gap", "filled", "cuts away"
    );

    for ((camera, shift), view) in rig.cameras().iter().zip(shifts).zip(coherence) {
        let by = match shift.planes {
            0 => "unknown".into(),
            _ => format!("({:.1}, {:.1})", tenths(-shift.shift.x), tenths(-shift.shift.y)),
        };
        let cuts = match view.carved_pixels {
            0 => "nothing".into(),
            cuts => format!("{:.1} %, {:.0} px deep", 100.0 * cuts as f64 / all as f64, view.carved_depth_px),
        };
        println!(
            "  {:width$}  {by:>16}  {:>4.1} px  {:>11}  {:>4.0} %  {cuts:>22}",
            camera.name(),
            tenths(shift.gain),
            format!("{:.1}, {:.1} px", shift.gap, shift.gap_after),
            100.0 * view.filled_share(),
        );
    }

    println!(
        "  shifted by: right and down, relative to what the others see; gain: by how much undoing it lessens the gaps\n  \
         gap: median at the outermost planes shared with other views, as it is and after all shifts are undone\n  \
         filled: share of its silhouettes that the hull fills\n  \
         cuts away: share of all silhouettes that this view alone cuts off, and how deep"
    );
}

/// Rounds to tenths, without a minus before a zero.
fn tenths(x: f64) -> f64 {
    (10.0 * x).round() / 10.0 + 0.0
}

/// Reports shifted views. Where there are none, reports views whose silhouettes the hull does not fill.
fn add_problems(
    rig: &Rig,
    shifts: &[ViewShift],
    coherence: &[SilhouetteCoherence],
    options: &Options,
    report: &mut Report,
) {
    let is_off = |shift: &ViewShift| {
        shift.planes >= MIN_PLANES
            && shift.shift.norm() > options.tolerance
            && shift.gain > MIN_GAIN * options.tolerance
    };
    let mut off_views: Vec<usize> = (0..shifts.len()).filter(|&k| is_off(&shifts[k])).collect();
    off_views.sort_by(|&a, &b| shifts[b].shift.norm().total_cmp(&shifts[a].shift.norm()));

    if rig.len() < 3 && !off_views.is_empty() {
        let gap = shifts.iter().map(|shift| shift.gap).fold(0.0, f64::max);
        report.add_problem(format!(
            "the silhouettes of the two views miss each other by {gap:.1} px; two views do not show which one is off: \
             calibrate both again"
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
    for (camera, view) in
        rig.cameras().iter().zip(coherence).filter(|(_, view)| view.filled_share() < MIN_FILLED)
    {
        let worst = (0..coherence.len())
            .max_by_key(|&k| coherence[k].carved_pixels)
            .filter(|&k| coherence[k].carved_pixels > 0);
        let by = worst.map_or(String::new(), |k| format!("; {} cuts most", rig.cameras()[k].name()));
        report.add_problem(format!(
            "{}: the hull fills only {:.0} % of its silhouettes{by}: check the masks (--pictures), the work volume and \
             --unseen",
            camera.name(),
            100.0 * view.filled_share()
        ));
    }
}

/// Why the hull of a frame is empty, and what would fill it.
fn why_empty(hull: &Hull, recorded: &RecordedHulls, frame: u32) -> Result<String> {
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

    for convention in PoseConvention::ALL {
        if recorded
            .recording
            .rig()
            .read_as(convention)
            .and_then(|rig| fills(&rig, recorded, frame))
            .unwrap_or(false)
        {
            return Ok(format!("{reason}; with {} it is not: convert the poses so", convention.describe()));
        }
    }

    Ok(format!(
        "{reason}; give --bounds around the subject, or --unseen abstain where no point is in sight of all"
    ))
}

/// Whether the hull of a frame by another rig holds anything.
fn fills(rig: &Rig, recorded: &RecordedHulls, frame: u32) -> Result<bool> {
    let data = HullData::new();
    data.add_views(rig.cameras())?;
    data.set_bounds(rig.work_volume()?)?;
    let hull = publish_masks(&data, &recorded.recording.masks(frame)?, 0.0)?;
    Ok(silhouette_coherence(&hull, 2 * STEP).iter().any(|view| view.filled_pixels > 0))
}
