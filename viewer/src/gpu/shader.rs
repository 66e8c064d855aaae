//! The source of the shaders for a number of views.
//!
//! Loops over views are expanded here, from lines between `// each view {` and `// }`, in which `VIEW` stands for the number.

use crate::cpu::{CELL, VISIBILITY_BIAS};
use crate::gpu::upload::MARGIN;
use crate::scene::Scene;
use ode_visual_hull::hull::Unseen;
use std::fmt::Write;

const BEGIN: &str = "// each view {";
const END: &str = "// }";

const SOURCES: [&str; 9] = [
    include_str!("../shaders/screen.wgsl"),
    include_str!("../shaders/views.wgsl"),
    include_str!("../shaders/eye.wgsl"),
    include_str!("../shaders/march.wgsl"),
    include_str!("../shaders/tiles.wgsl"),
    include_str!("../shaders/depth_map.wgsl"),
    include_str!("../shaders/blend.wgsl"),
    include_str!("../shaders/subject.wgsl"),
    include_str!("../shaders/sweep.wgsl"),
];

/// Planes of a sweep that pixels wait for together.
pub const BAND: u32 = 5;

/// What the shaders' source depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Variant {
    /// The number of views.
    pub views: usize,
    /// The number of views that have to see a point of the hull, where views abstain.
    pub min_views: Option<usize>,
    /// Whether the surface is moved to where colours agree.
    pub refines: bool,
}

impl Variant {
    /// The variant for `scene`.
    pub fn new(scene: &Scene, refines: bool) -> Self {
        let min_views = match scene.hull.unseen() {
            Unseen::Outside => None,
            Unseen::Abstain { min_views } => Some(min_views.max(1)),
        };
        Self { views: scene.views.len(), min_views, refines }
    }

    /// All shaders.
    pub fn source(&self) -> String {
        let Self { views, min_views, refines } = *self;
        let mut source = format!(
            "const VIEWS: u32 = {views}u;\nconst ABSTAINS: bool = {};\nconst MIN_VIEWS: u32 = {}u;\nconst REFINES: bool = {refines};\n\
             const CELL: f32 = {CELL}.0;\nconst MARGIN: f32 = {MARGIN}.0;\nconst VISIBILITY_BIAS: f32 = {VISIBILITY_BIAS};\n\
             const BAND: f32 = {BAND}.0;\n",
            min_views.is_some(),
            min_views.unwrap_or(views),
        );
        for part in SOURCES {
            source.push_str(&expanded(part, views));
        }
        source
    }
}

/// `source` with its loops over views expanded.
fn expanded(source: &str, views: usize) -> String {
    let mut expanded = String::new();
    let mut body = None;
    for line in source.lines() {
        match (line.trim(), &mut body) {
            (BEGIN, _) => body = Some(String::new()),
            (END, Some(lines)) => {
                for view in 0..views {
                    expanded.push_str(&lines.replace("VIEW", &view.to_string()));
                }
                body = None;
            }
            (_, Some(lines)) => _ = writeln!(lines, "{line}"),
            (_, None) => _ = writeln!(expanded, "{line}"),
        }
    }
    expanded
}
