//! `states.csv` of a run: where the bodies were in each frame of the film.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use ode_visual_hull::{Error, Result};
use std::fmt::Display;
use std::path::Path;

/// The columns of the file: time, number of the body from 1, position, rotation (quaternion, real part first), velocity and
/// angular velocity, in the world's frame.
pub(crate) const HEADER: &str = "time_s,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz";

/// Greatest difference of a quaternion's length from 1; the file has six decimals.
const NORM_TOLERANCE: f64 = 1e-3;

/// The poses of the bodies of a run over time.
#[derive(Debug, Clone, PartialEq)]
pub struct States {
    /// The time of each entry, in seconds of the film.
    times: Vec<f64>,
    body_count: usize,
    /// World from body, entry by entry.
    poses: Vec<Isometry3<f64>>,
}

/// A line of the file.
struct Row {
    time: f64,
    /// From 1.
    body: usize,
    pose: Isometry3<f64>,
}

impl States {
    /// The file's name in the folder of a run.
    pub const NAME: &'static str = "states.csv";

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, and all errors of [`from_csv`](Self::from_csv).
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|e| {
            Error::file(
                path,
                format!("expected the states of a run, found: {e}; give the {} of one", Self::NAME),
            )
        })?;
        Self::from_csv(&text).map_err(|e| Error::file(path, e))
    }

    /// Reads the text of such a file: entries in the order of time, each with the same bodies in the order of their numbers.
    ///
    /// # Errors
    /// Another header, no entries, a line with another number of columns, a number that is none or not finite, a rotation that
    /// is no unit quaternion, an entry without one of the bodies, a time that decreases. The message names the line.
    pub fn from_csv(text: &str) -> Result<Self> {
        let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
        let heading = lines.next().map_or("", |(_, line)| line);
        if heading != HEADER {
            let name = Self::NAME;
            let found = format!("found \"{heading}\"; give the {name} of a run");
            return Err(at(1, format!("expected the columns {HEADER}, {found}")));
        }

        let row = |(line, text)| Ok((line, Row::parse(text).map_err(|problem| at(line, problem))?));
        let rows = lines.filter(|(_, text)| !text.is_empty()).map(row).collect::<Result<Vec<_>>>()?;
        Self::of(&rows)
    }

    /// The states of these lines, each with its number.
    fn of(rows: &[(usize, Row)]) -> Result<Self> {
        let Some((last, _)) = rows.last() else {
            return Err(at(1, "expected the states of one body at least, found none; run with bodies"));
        };

        // The first entry tells how many bodies there are.
        let second_entry = rows.iter().skip(1).position(|(_, row)| row.body == 1);
        let body_count = second_entry.map_or(rows.len(), |k| k + 1);
        let mut times: Vec<f64> = Vec::new();
        for (k, (line, row)) in rows.iter().enumerate() {
            let before = times.last().copied().unwrap_or(row.time);
            row.check(k % body_count + 1, body_count, before).map_err(|problem| at(*line, problem))?;
            if row.body == 1 {
                times.push(row.time);
            }
        }

        let next = rows.len() % body_count + 1;
        if next != 1 {
            let found = "found the end of the file, which has been cut off; write the states again";
            return Err(at(*last, format!("expected body {next} of {body_count} next, {found}")));
        }
        Ok(Self { times, body_count, poses: rows.iter().map(|(_, row)| row.pose).collect() })
    }

    /// The time of each entry, in seconds of the film. They do not decrease, and there is at least one.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The number of bodies; at least one.
    pub fn body_count(&self) -> usize {
        self.body_count
    }

    /// The poses of the bodies, world from body, at entry `k`; `None` if there are not as many entries.
    pub fn poses(&self, k: usize) -> Option<&[Isometry3<f64>]> {
        self.poses.chunks(self.body_count).nth(k)
    }
}

fn at(line: usize, problem: impl Display) -> Error {
    Error::argument(format!("line {line}: {problem}"))
}

impl Row {
    fn parse(line: &str) -> std::result::Result<Self, String> {
        let cells: Vec<_> = line.split(',').map(str::trim).collect();
        let names: Vec<_> = HEADER.split(',').collect();
        if cells.len() != names.len() {
            return Err(format!(
                "expected {} columns, found {}; the file may have been cut off",
                names.len(),
                cells.len()
            ));
        }

        let number = |column: usize| {
            let number = cells[column].parse().ok().filter(|number: &f64| number.is_finite());
            let (name, found) = (names[column], cells[column]);
            number.ok_or_else(|| {
                format!("column {name}: expected a finite number, found \"{found}\"; write the states again")
            })
        };
        let numbers = (0..names.len()).map(number).collect::<std::result::Result<Vec<_>, _>>()?;
        let body = cells[1].parse().ok().filter(|&body: &usize| body > 0);
        let body = body.ok_or_else(|| {
            format!(
                "column body: expected a number from 1 on, found \"{}\"; write the states again",
                cells[1]
            )
        })?;

        let quaternion = Quaternion::new(numbers[5], numbers[6], numbers[7], numbers[8]);
        let norm = quaternion.norm();
        if (norm - 1.0).abs() > NORM_TOLERANCE {
            return Err(format!(
                "columns qw to qz: expected a unit quaternion, found one of length {norm}; write the states again"
            ));
        }
        let position = Translation3::new(numbers[2], numbers[3], numbers[4]);
        let pose = Isometry3::from_parts(position, UnitQuaternion::new_normalize(quaternion));
        Ok(Self { time: numbers[0], body, pose })
    }

    /// Checks that this is `body` of `count`, and that its time follows that of the line `before`.
    fn check(&self, body: usize, count: usize, before: f64) -> std::result::Result<(), String> {
        let time = self.time;
        if self.body != body {
            let found =
                format!("found body {}; each entry has the bodies of the first one, in order", self.body);
            return Err(format!("expected body {body} of {count}, {found}"));
        }
        if body > 1 && time != before {
            return Err(format!(
                "expected {before} s, as for body 1, found {time} s; write the states again"
            ));
        }
        if time < before {
            return Err(format!("expected {before} s or later, found {time} s; sort the entries by time"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text of a file with these times and bodies; body b is at (b, time, 0).
    fn file(rows: &[(f64, usize)]) -> String {
        let row =
            |(time, body): &(f64, usize)| format!("{time},{body},{body},{time},0,1,0,0,0,0,0,0,0,0,0\n");
        format!("{HEADER}\n{}", rows.iter().map(row).collect::<String>())
    }

    const TWO_BODIES: [(f64, usize); 6] = [(0.1, 1), (0.1, 2), (0.2, 1), (0.2, 2), (0.2, 1), (0.2, 2)];

    #[test]
    fn poses_are_those_of_all_bodies_at_each_time_in_order() {
        let states = States::from_csv(&file(&TWO_BODIES)).unwrap();
        assert_eq!((states.times(), states.body_count()), (&[0.1, 0.2, 0.2][..], 2));
        for (k, &time) in states.times().iter().enumerate() {
            let expected = [1.0, 2.0].map(|body| Isometry3::translation(body, time, 0.0));
            assert_eq!(states.poses(k), Some(&expected[..]));
        }
        assert_eq!(states.poses(3), None);

        // Lines may end as on Windows, and the last one may be empty.
        let windows = format!("{}\r\n", file(&TWO_BODIES).replace('\n', "\r\n"));
        assert_eq!(States::from_csv(&windows).unwrap(), states);
        let single = States::from_csv(&file(&[(0.1, 1)])).unwrap();
        assert_eq!((single.times().len(), single.body_count()), (1, 1));
    }

    #[test]
    fn files_that_are_no_states_are_refused_with_their_line() {
        let refused = |text: &str, expected: &str| {
            let message = States::from_csv(text).unwrap_err().to_string();
            assert!(message.contains(expected), "expected {expected:?} in {message:?}");
        };
        refused("", "line 1: expected the columns time_s,body");
        refused("frame,time\n0,0\n", "found \"frame,time\"");
        refused(&file(&[]), "line 1: expected the states of one body at least");

        let text = file(&TWO_BODIES);
        refused(&text.replacen(",0,0\n", ",0\n", 1), "line 2: expected 15 columns, found 14");
        refused(
            &text.replacen("0.2,1,1", "0.2,1,NaN", 1),
            "line 4: column x: expected a finite number, found \"NaN\"",
        );
        refused(&text.replacen("0.2,1,1", "0.2,1,1e999", 1), "line 4: column x: expected a finite number");
        refused(&text.replacen(",0,0\n", ",0,inf\n", 1), "line 2: column wz");
        refused(&text.replacen("0.1,1,1", "x,1,1", 1), "line 2: column time_s");
        refused(
            &text.replacen("0.1,1,1", "0.1,1.5,1", 1),
            "column body: expected a number from 1 on, found \"1.5\"",
        );
        refused(&text.replacen("0.1,1,1", "0.1,-1,1", 1), "line 2: column body");
        refused(
            &text.replacen(",1,0,0,0,", ",0,0,0,0,", 1),
            "line 2: columns qw to qz: expected a unit quaternion",
        );
    }

    #[test]
    fn entries_without_a_body_and_times_that_decrease_are_refused() {
        for (rows, expected) in [
            (&[(0.1, 2)][..], "line 2: expected body 1 of 1, found body 2"),
            (&[(0.1, 1), (0.1, 3)], "line 3: expected body 2 of 2, found body 3"),
            (&[(0.1, 1), (0.1, 2), (0.2, 2)], "line 4: expected body 3 of 3, found body 2"),
            (&[(0.1, 1), (0.1, 2), (0.2, 1), (0.3, 1)], "line 5: expected body 2 of 2, found body 1"),
            (&[(0.1, 1), (0.1, 2), (0.2, 1)], "line 4: expected body 2 of 2 next, found the end of the file"),
            (&[(0.1, 1), (0.2, 1), (0.2, 2)], "line 4: expected body 1 of 1, found body 2"),
            (&[(0.1, 1), (0.2, 2)], "line 3: expected 0.1 s, as for body 1, found 0.2 s"),
            (&[(0.2, 1), (0.1, 1)], "line 3: expected 0.2 s or later, found 0.1 s"),
        ] {
            let message = States::from_csv(&file(rows)).unwrap_err().to_string();
            assert!(message.contains(expected), "expected {expected:?} in {message:?}");
        }
    }

    #[test]
    fn an_error_about_a_file_names_it() {
        let message = States::read("nowhere/states.csv").unwrap_err().to_string();
        assert!(message.starts_with("nowhere/states.csv: expected the states of a run, found"), "{message}");
    }
}
