//! Checks of a recording's silhouettes: views that are shifted, views that cut away what others see, empty hulls.

use super::{Options, Report};
use crate::progress;
use ode_visual_hull::Result;
use ode_visual_hull::hull::{EmptyReason, Hull, HullData};
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::rig::{PoseConvention, Rig};
use ode_visual_hull_check::{
    EpipolarTangency, SilhouetteCoherence, ViewShift, silhouette_coherence, total_coherence,
};
use ode_visual_hull_film::RecordedHulls;

/// Step between the pixels, and between the rows, whose rays are intersected with the hull.
const STEP: usize = 4;

/// Greatest number of frames in which coherence, which is slow, is computed.
const COHERENCE_FRAMES: usize = 8;

/// Least number of tangent planes that a shift must rest on to be reported.
const MIN_PLANES: usize = 4;

/// Least gain of undoing a shift, as a fraction of the tolerance. Long shifts with a small gain are hardly determined
/// by the pairs of cameras.
const MIN_GAIN: f64 = 0.1;

/// Fraction of a view's silhouettes that the hull must fill; below it this view or another one is wrong.
const MIN_FILLED: f64 = 0.75;

/// Prints a table of the views' shifts and coherence, and reports problems.
pub fn describe_silhouettes(recorded: &RecordedHulls, options: &Options, report: &mut Report) -> Result<()> {
    let frames = match (options.frames, options.frame) {
        (1, Some(frame)) => vec![frame],
        (max_count, _) => recorded.spread_frames(max_count as usize),
    };

    // Tangent planes of all frames, coherence of some, and the frames whose hull fills nothing.
    let (mut tangency, mut coherence, mut empty) = (EpipolarTangency::new(), Vec::new(), Vec::new());
    let bar = progress::bar(frames.len(), "silhouettes");
    let frame_step = frames.len().div_ceil(COHERENCE_FRAMES);
    for (k, &frame) in frames.iter().enumerate() {
        let hull = recorded.hull(frame)?;
        tangency.add(&hull);
        if k % frame_step == 0 {
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

    report_problems(recorded.recording.rig(), &shifts, &coherence, options, report);
    if let Some((frame, hull)) = empty.first() {
        report
            .add_problem(format!("frame {frame}: the hull is empty: {}", why_empty(hull, recorded, *frame)?));
    }
    Ok(())
}

/// Prints a row for each camera, and a legend.
fn print_table(rig: &Rig, shifts: &[ViewShift], coherence: &[SilhouetteCoherence]) {
    let width = rig.cameras().iter().map(|camera| camera.name().chars().count()).max().unwrap_or(0).max(6);
    let all_pixels: usize = coherence.iter().map(|view| view.pixels).sum();
    println!(
        "  {:width$}  {:>16}  {:>7}  {:>11}  {:>6}  {:>22}",
        "camera", "shifted by, px", "gain", "error", "filled", "cuts away"
    );

    for ((camera, shift), view) in rig.cameras().iter().zip(shifts).zip(coherence) {
        let by = match shift.planes {
            0 => "unknown".into(),
            _ => format!("({:.1}, {:.1})", tenths(-shift.shift.x), tenths(-shift.shift.y)),
        };
        let cuts = match view.carved_pixels {
            0 => "nothing".into(),
            cuts => format!(
                "{:.1} %, {:.0} px deep",
                100.0 * cuts as f64 / all_pixels as f64,
                view.carved_depth_px
            ),
        };
        println!(
            "  {:width$}  {by:>16}  {:>4.1} px  {:>11}  {:>4.0} %  {cuts:>22}",
            camera.name(),
            tenths(shift.gain),
            format!("{:.1}, {:.1} px", shift.error, shift.error_after),
            100.0 * view.filled_share(),
        );
    }

    println!(
        "  shifted by: right and down, relative to the other views; gain: decrease of the mean error if undone\n  \
         error: median at the outermost planes shared with other views, as it is and after all shifts are undone\n  \
         filled: share of its silhouettes that the hull fills; cuts away: share of all silhouettes that this view \
         alone removes from the hull, and how deep"
    );
}

/// Rounds to tenths, without a minus sign before zero.
fn tenths(x: f64) -> f64 {
    (10.0 * x).round() / 10.0 + 0.0
}

/// Reports views that are shifted, or else views whose silhouettes the hull does not fill.
fn report_problems(
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

    // Two views show that one of them is shifted, but not which.
    if rig.len() < 3 && !off_views.is_empty() {
        let error = shifts.iter().map(|shift| shift.error).fold(0.0, f64::max);
        report.add_problem(format!(
            "the silhouettes of the two views disagree by {error:.1} px; with two views alone it is unknown which one is \
             off: calibrate both again"
        ));
        return;
    }

    for &k in &off_views {
        let offset = -shifts[k].shift;
        report.add_problem(format!(
            "{}: its silhouettes lie {:.1} px off, by ({:.1}, {:.1}) px right and down, more than {} px; calibrate it \
             again, or move its principal point by as much",
            rig.cameras()[k].name(),
            offset.norm(),
            offset.x,
            offset.y,
            options.tolerance
        ));
    }
    // Shifted views are a sufficient cause of silhouettes that are not filled.
    if !off_views.is_empty() {
        return;
    }

    let unfilled = rig.cameras().iter().zip(coherence).filter(|(_, view)| view.filled_share() < MIN_FILLED);
    for (camera, view) in unfilled {
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

/// Why the hull of a frame is empty, and the next step.
fn why_empty(hull: &Hull, recorded: &RecordedHulls, frame: u32) -> Result<String> {
    let name = |view: usize| hull.views()[view].name().to_owned();
    let reason = match hull.empty_reason() {
        Some(EmptyReason::NoViews) => "no view takes part".into(),
        Some(EmptyReason::EmptySilhouette { view }) => format!("the mask of {} holds no subject", name(view)),
        Some(EmptyReason::NothingInCommon { view }) => format!(
            "the silhouette of {} has no point in common with the work volume and the views before it",
            name(view)
        ),
        None => "no point is subject in all views".into(),
    };

    // Poses in another convention are a common cause.
    for convention in PoseConvention::ALL {
        if recorded
            .recording
            .rig()
            .read_as(convention)
            .and_then(|rig| is_filled(&rig, recorded, frame))
            .unwrap_or(false)
        {
            return Ok(format!(
                "{reason}; with {} it is not empty: convert the poses in this way",
                convention.describe()
            ));
        }
    }

    Ok(format!(
        "{reason}; give --bounds around the subject, or --unseen abstain where no point is seen by all cameras"
    ))
}

/// Whether the hull of a frame's masks is not empty if `rig` replaces the recording's.
fn is_filled(rig: &Rig, recorded: &RecordedHulls, frame: u32) -> Result<bool> {
    let data = HullData::new();
    data.add_views(rig.cameras())?;
    data.set_bounds(rig.work_volume()?)?;
    let hull = publish_masks(&data, &recorded.recording.masks(frame)?, 0.0)?;
    Ok(silhouette_coherence(&hull, 2 * STEP).iter().any(|view| view.filled_pixels > 0))
}
