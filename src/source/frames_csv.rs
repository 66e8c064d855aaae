//! `frames.csv`, the times of a recording's images.
//!
//! The file is text with one line per frame; the first line names the columns:
//!
//! ```text
//! frame,left,right          or, with one time for all cameras:     frame,time
//! 0,12.000,12.003                                                  0,0.0
//! 1,12.040,12.043                                                  1,0.04
//! 2,,12.083
//! ```
//!
//! `frame` is the number of an image: the number in its file name, or its position in the video from 0. The other
//! columns are named after the cameras and hold seconds on a clock that all cameras share; an empty cell means that
//! this camera has no such image. Times increase within a column. Empty lines are ignored. Names with a comma are not
//! possible.

use crate::{Error, Result};
use std::collections::BTreeMap;
use std::ops::Bound;
use std::path::Path;

/// The file's name in the folder of a recording.
pub const NAME: &str = "frames.csv";

/// Reads the times of `cameras` in seconds by frame number: one table per camera, in the order of `cameras`.
///
/// # Errors
/// A file that cannot be read; a camera without a column, a line with another number of cells than columns, a frame
/// that is not a number or is listed twice, a time that is not a number or does not increase. The message names the
/// line.
pub fn load(path: impl AsRef<Path>, cameras: &[&str]) -> Result<Vec<BTreeMap<u32, f64>>> {
    let path = path.as_ref();
    let text = std::fs::read_to_string(path)
        .map_err(|e| Error::file(path, format!("expected a table of times, found: {e}")))?;
    parse(&text, cameras).map_err(|problem| Error::file(path, problem))
}

fn parse(text: &str, cameras: &[&str]) -> std::result::Result<Vec<BTreeMap<u32, f64>>, String> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());

    let heading = lines.next().map_or("", |(_, line)| line);
    let names: Vec<_> = heading.split(',').map(str::trim).collect();
    let columns = columns(&names, cameras)?;

    let mut times = vec![BTreeMap::new(); cameras.len()];
    for (index, line) in lines {
        let cells: Vec<_> = line.split(',').map(str::trim).collect();
        let at = |problem: String| format!("line {}: {problem}", index + 1);
        if cells.len() != names.len() {
            return Err(at(format!("expected {} cells, one per column, found {}", names.len(), cells.len())));
        }

        let frame = cells[0]
            .parse()
            .map_err(|_| at(format!("expected the number of a frame, found \"{}\"", cells[0])))?;

        for (of_camera, &column) in times.iter_mut().zip(&columns) {
            enter(of_camera, frame, names[column], cells[column]).map_err(at)?;
        }
    }
    Ok(times)
}

/// The index of each camera's column.
fn columns(names: &[&str], cameras: &[&str]) -> std::result::Result<Vec<usize>, String> {
    if names[0] != "frame" {
        return Err(format!(
            "line 1: expected columns \"frame\" and the cameras' names, or \"frame,time\", found \"{}\"",
            names.join(",")
        ));
    }
    let shared = (names.len() == 2 && names[1] == "time").then_some(1);

    let column = |camera: &&str| {
        let own = names.iter().skip(1).position(|name| name == camera).map(|at| at + 1);
        own.or(shared).ok_or_else(|| {
            format!(
                "line 1: expected a column \"{camera}\", found \"{}\"; name them as the cameras",
                names.join(",")
            )
        })
    };
    cameras.iter().map(column).collect()
}

/// Adds the time in a cell to a camera's table; an empty cell adds nothing.
fn enter(
    times: &mut BTreeMap<u32, f64>,
    frame: u32,
    name: &str,
    cell: &str,
) -> std::result::Result<(), String> {
    if cell.is_empty() {
        return Ok(());
    }
    let time = cell.parse().ok().filter(|time: &f64| time.is_finite());
    let time = time.ok_or_else(|| format!("column \"{name}\": expected seconds, found \"{cell}\""))?;

    if times.insert(frame, time).is_some() {
        return Err(format!("expected each frame once, found frame {frame} again; remove one"));
    }

    // Lines may be in any order, so compare with the neighbours on both sides.
    let before = times.range(..frame).next_back().filter(|&(_, &before)| before >= time);
    let after =
        times.range((Bound::Excluded(frame), Bound::Unbounded)).next().filter(|&(_, &after)| after <= time);
    match before.or(after) {
        None => Ok(()),
        Some((other, at)) => Err(format!(
            "column \"{name}\": expected times that grow with the frame, found {time} for frame {frame} and {at} for \
             frame {other}"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_camera_has_its_times_and_an_empty_cell_is_no_image() {
        let text = "\u{feff}frame, right,left\r\n0,12.003,12\r\n\r\n2,12.083,\r\n1,12.043,12.04\r\n";
        let times = parse(text, &["left", "right"]).unwrap();
        assert_eq!(times[0], BTreeMap::from([(0, 12.0), (1, 12.04)]));
        assert_eq!(times[1], BTreeMap::from([(0, 12.003), (1, 12.043), (2, 12.083)]));
    }

    #[test]
    fn a_single_column_time_applies_to_all_cameras() {
        let times = parse("frame,time\n5,0.5\n", &["left", "right"]).unwrap();
        assert_eq!(times, [BTreeMap::from([(5, 0.5)]), BTreeMap::from([(5, 0.5)])]);
        // With further columns, `time` is a camera's name and not the shared clock.
        assert!(parse("frame,time,left\n5,0.5,1\n", &["left", "right"]).is_err());
    }

    #[test]
    fn errors_name_the_line_and_what_was_found() {
        let cases: [(&str, &[&str]); 9] = [
            ("", &["line 1", "\"frame\""]),
            ("time,frame\n", &["line 1", "\"time,frame\""]),
            ("frame,left\n", &["line 1", "column \"right\"", "\"frame,left\""]),
            ("frame,left,right\n0,1\n", &["line 2", "3 cells", "found 2"]),
            ("frame,left,right\n-1,1,1\n", &["line 2", "number of a frame", "\"-1\""]),
            ("frame,left,right\n\n0,1,nan\n", &["line 3", "\"right\"", "seconds", "\"nan\""]),
            ("frame,left,right\n0,1,x\n", &["line 2", "\"right\"", "seconds", "\"x\""]),
            ("frame,left,right\n0,1,1\n0,2,2\n", &["line 3", "frame 0 again"]),
            ("frame,left,right\n0,1,1\n1,1,2\n", &["line 3", "\"left\"", "grow", "1 for frame 1", "frame 0"]),
        ];
        for (text, parts) in cases {
            let message = parse(text, &["left", "right"]).unwrap_err();
            parts.iter().for_each(|part| assert!(message.contains(part), "{message:?} lacks {part:?}"));
        }
        // The largest frame number has no successor.
        assert!(parse("frame,time\n4294967295,1\n", &["left"]).is_ok());
    }
}
