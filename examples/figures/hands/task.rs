//! What a pair of hands is to do with a box, and when it has done so.

use super::hand_script::HandScript;
use nalgebra::{Isometry3, Point3, Vector3, vector};

/// The sides of the box in metres; the hands press its longest side.
pub const BOX: [f64; 3] = [0.2, 0.15, 0.15];

/// Seconds of a step, and by how many the hull is behind the frames.
pub const STEP: f64 = 1.0 / 240.0;
const LATENCY: f64 = 1.0 / super::RATE;

/// The gap between open hands, and between hands that would be 12 mm in the box.
const OPEN: f64 = 0.32;
const SHUT: f64 = BOX[0] - 0.012;

/// Open hands close about the box while they stand still.
const CLOSE: [(f64, [f64; 1]); 2] = [(0.3, [OPEN]), (0.9, [SHUT])];

/// The height of a hand's middle that holds the box on the floor.
const LOW: f64 = 0.5 * BOX[2] + 0.005;

/// When hands that have closed begin to move.
const BEGIN: f64 = 1.0;

/// What the hands are to do.
#[derive(Debug, Clone, Copy)]
pub struct Task {
    pub name: &'static str,
    /// The least number of attempts of a hundred that succeed, without noise and with it; `None` where it is only reported.
    pub least: Option<[f64; 2]>,
    pub script: HandScript<'static>,
    /// Where the box is at first, by how much attempts differ in that, and when it is let go.
    pub start: Vector3<f64>,
    pub spread: Vector3<f64>,
    pub let_go: f64,
    /// Where another box stands.
    pub base: Option<Vector3<f64>>,
    /// Seconds from the last pose to the end.
    wait: f64,
    /// Judges the poses of the box at all steps.
    has_succeeded: fn(&Task, &[Isometry3<f64>]) -> bool,
}

const LIFT: Task = Task {
    name: "lift",
    least: Some([95.0, 80.0]),
    script: HandScript {
        poses: &[(BEGIN, [0.0, 0.0, LOW, 0.0]), (2.0, [0.0, 0.0, LOW + 0.4, 0.0])],
        gaps: &CLOSE,
    },
    start: Vector3::new(0.0, 0.0, 0.5 * BOX[2]),
    spread: Vector3::new(0.01, 0.01, 0.0),
    let_go: 0.0,
    base: None,
    wait: 1.0,
    has_succeeded: |task, path| task.lifted(path) > 0.8,
};

const CARRY: Task = Task {
    name: "carry",
    script: HandScript {
        poses: &[
            (BEGIN, [0.0, 0.0, LOW, 0.0]),
            (1.8, [0.0, 0.0, LOW + 0.3, 0.0]),
            (2.8, [0.3, 0.4, LOW + 0.4, 0.0]),
        ],
        gaps: &CLOSE,
    },
    has_succeeded: |task, path| task.lifted(path) > 0.8 && task.slip(path) < 0.05,
    ..LIFT
};

/// As [`CARRY`], and the hands turn by 46 degrees. Half-way no camera looks through the gap between them, into which the hull
/// bulges by up to 3 cm from both sides.
const TURN: Task = Task {
    name: "carry_turning",
    least: None,
    script: HandScript {
        poses: &[
            (BEGIN, [0.0, 0.0, LOW, 0.0]),
            (1.8, [0.0, 0.0, LOW + 0.3, 0.0]),
            (2.8, [0.3, 0.4, LOW + 0.4, 0.8]),
        ],
        gaps: &CLOSE,
    },
    ..CARRY
};

const THROW: Task = Task {
    name: "throw",
    least: Some([90.0, 0.0]),
    script: HandScript {
        poses: &[(BEGIN, [0.0, 0.0, LOW, 0.0]), (1.7, [0.0, 0.0, LOW + 0.8, 0.0])],
        gaps: &[CLOSE[0], CLOSE[1], (1.33, [SHUT]), (1.53, [OPEN])],
    },
    has_succeeded: Task::has_flown,
    ..LIFT
};

/// The hands go down with the falling box, about as fast, while they close.
const CATCH: Task = Task {
    name: "catch",
    least: Some([70.0, 0.0]),
    script: HandScript {
        poses: &[(0.48, [0.0, 0.0, 0.8, 0.0]), (0.98, [0.0, 0.0, 0.25, 0.0])],
        gaps: &[(0.48, [OPEN]), (0.72, [SHUT])],
    },
    start: Vector3::new(0.0, 0.0, 0.85),
    spread: Vector3::new(0.01, 0.01, 0.03),
    let_go: 0.5,
    has_succeeded: |task, path| task.in_hands(path, path.len() - 1).norm() < 0.1,
    ..LIFT
};

const STACK: Task = Task {
    name: "stack",
    least: Some([80.0, 0.0]),
    script: HandScript {
        poses: &[
            (BEGIN, [0.0, 0.0, LOW, 0.0]),
            (1.8, [0.0, 0.0, LOW + 0.3, 0.0]),
            (2.8, [0.0, 0.4, LOW + 0.3, 0.0]),
            (3.6, [0.0, 0.4, LOW + BOX[2], 0.0]),
        ],
        gaps: &[CLOSE[0], CLOSE[1], (3.8, [SHUT]), (4.4, [OPEN])],
    },
    base: Some(Vector3::new(0.0, 0.4, 0.5 * BOX[2])),
    wait: 1.8,
    has_succeeded: Task::is_stacked,
    ..LIFT
};

/// What the hands do.
pub const TASKS: [Task; 6] = [LIFT, CARRY, TURN, THROW, CATCH, STACK];

impl Task {
    /// The time at which the outcome is judged.
    pub fn end(&self) -> f64 {
        self.script.poses.last().map_or(0.0, |(time, _)| *time) + self.wait
    }

    /// How many of the attempts have succeeded.
    pub fn count_successes(&self, paths: &[Vec<Isometry3<f64>>]) -> usize {
        paths.iter().filter(|path| (self.has_succeeded)(self, path)).count()
    }

    /// How far the box is lifted at the end, over how far the hands are.
    pub fn lifted(&self, path: &[Isometry3<f64>]) -> f64 {
        let rise = path.last().map_or(0.0, |end| end.translation.z) - self.start.z;
        rise / (self.shown(path.len()).translation.z - LOW)
    }

    /// The hands as the hull shows them in a step.
    fn shown(&self, step: usize) -> Isometry3<f64> {
        self.script.pose(step as f64 * STEP - LATENCY)
    }

    /// The place of the box in the frame of the hands.
    fn in_hands(&self, path: &[Isometry3<f64>], step: usize) -> Vector3<f64> {
        self.shown(step).inverse_transform_point(&Point3::from(path[step].translation.vector)).coords
    }

    /// How far the box has moved between the hands since these began to move, in metres.
    fn slip(&self, path: &[Isometry3<f64>]) -> f64 {
        let began = ((BEGIN + LATENCY) / STEP) as usize;
        (self.in_hands(path, path.len() - 1) - self.in_hands(path, began)).norm()
    }

    /// Whether the box rises above the hands by seven tenths of what their largest speed gives.
    fn has_flown(&self, path: &[Isometry3<f64>]) -> bool {
        let height = |step: usize| self.shown(step).translation.z;
        let speed = |step: usize| (height(step) - height(step - 1)) / STEP;
        let fastest = (1..path.len()).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap_or(1);
        let apex = path.iter().map(|pose| pose.translation.z).fold(0.0, f64::max);
        apex > height(fastest) + 0.7 * speed(fastest).powi(2) / (2.0 * 9.81)
    }

    /// Whether the box stands on the other one.
    fn is_stacked(&self, path: &[Isometry3<f64>]) -> bool {
        let Some((end, base)) = path.last().zip(self.base) else { return false };
        let above = end.translation.vector - base - vector![0.0, 0.0, BOX[2]];
        above.z.abs() < 0.01 && above.xy().norm() < 0.05 && (end.rotation * Vector3::z()).z > 0.99
    }
}
