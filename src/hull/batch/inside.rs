//! Which of many points are inside, as many at a time as a vector register holds.

use super::super::points::{LANES, Points};
use super::fold::{Folded, FoldedBox};
use crate::vectorised::vectorised;

/// What counts as inside a silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Within {
    /// A subject pixel.
    Subject,
    /// A subject pixel or one beside it: nothing that any edge model calls inside is missed.
    NearSubject,
}

vectorised! {
    /// Adds the places of the points that all views see `within` the silhouette, in their order.
    ///
    /// `volume` is the work volume where it may cut points off.
    pub(super) fn find(
        points: &Points,
        views: &[Folded],
        volume: Option<&FoldedBox>,
        within: Within,
        found: &mut Vec<u32>,
    ) {
        let near = f32::from(u8::from(within == Within::NearSubject));
        let mut start = 0;
        for (sphere, blocks) in points.clusters() {
            let asked = !points.is_clustered()
                || views.iter().all(|view| view.may_touch(&sphere.centre, sphere.radius, near));
            for (block, first) in blocks.iter().zip((start..).step_by(LANES)) {
                if !asked {
                    break;
                }
                let mut inside = u16::MAX;
                for view in views {
                    inside &= seen(view, block, within);
                    if inside == 0 {
                        break;
                    }
                }
                if inside != 0 && let Some(volume) = volume {
                    inside &= volume.contains(&block.x, &block.y, &block.z);
                }
                inside &= (u32::from(u16::MAX) >> (LANES - points.filled(first / LANES))) as u16;
                while inside != 0 {
                    found.push((first + inside.trailing_zeros() as usize) as u32);
                    inside &= inside - 1;
                }
            }
            start += blocks.len() * LANES;
        }
    }
}

/// Which points of a block a view sees within the silhouette, a bit each.
#[inline(always)]
fn seen(view: &Folded, block: &super::super::points::Block, within: Within) -> u16 {
    let tables = &view.tables;
    let bits = if within == Within::Subject { tables.subject } else { tables.near };
    let (columns, rows) = view.pixels(&view.project(&block.x, &block.y, &block.z));
    let mut seen = 0;
    let words = tables.words as u32;
    let mut places = [0; LANES];
    for k in 0..LANES {
        places[k] = rows[k] * words + (columns[k] >> 6);
    }
    for k in 0..LANES {
        let word = bits.get(places[k] as usize).copied().unwrap_or(0);
        seen |= ((word >> (columns[k] & 63)) as u16 & 1) << k;
    }
    seen
}
