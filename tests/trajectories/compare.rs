//! How far the hull's run lies off the reference.

use super::reference::Reference;
use super::stage::State;

/// RMS over the reference's rows of the distance between body centres, of the worst body, in pixels of the rig.
pub fn rms_px(reference: &Reference, states: &[Vec<State>]) -> f64 {
    let bodies = reference.rows[0].1.len();
    let squared = |body: usize| -> f64 {
        let rows = reference.rows.iter();
        let off = rows.map(|(k, poses)| {
            let here = states[*k][body].pose.translation.vector;
            (here - poses[body].translation.vector).norm_squared()
        });
        off.sum::<f64>() / reference.rows.len() as f64
    };
    (0..bodies).map(squared).fold(0.0, f64::max).sqrt() / reference.pixel
}
