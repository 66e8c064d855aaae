//! Text files of words and numbers, line by line, with the context for error messages.

use super::format::pixels;
use crate::{Error, Result};
use std::collections::HashMap;

/// A line that is not empty.
pub(super) struct Line<'a> {
    /// The number of the line, from 1.
    pub(super) number: usize,
    pub(super) text: &'a str,
    pub(super) words: Vec<&'a str>,
}

/// The lines of `text` that are not empty. A byte order mark at the start is skipped.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let text = text.trim_start_matches('\u{feff}');
    let all = text.lines().enumerate().map(|(index, line)| Line {
        number: index + 1,
        text: line.trim(),
        words: line.split_whitespace().collect(),
    });
    all.filter(|line| !line.words.is_empty())
}

/// Whether a word is a number; NaN and infinities count.
pub(super) fn is_number(word: &str) -> bool {
    word.parse::<f64>().is_ok()
}

impl Line<'_> {
    /// Parses the words from position `from` on as exactly `N` finite numbers.
    pub(super) fn numbers<const N: usize>(&self, from: usize, next_step: &str) -> Result<[f64; N]> {
        let words = self.words.get(from..).unwrap_or_default();
        let numbers = words.iter().map(|word| self.number_in(word, next_step)).collect::<Result<Vec<_>>>()?;
        numbers
            .try_into()
            .map_err(|_| self.fail(format!("expected {N} numbers, found {}; {next_step}", words.len())))
    }

    /// Parses `word` as a finite number.
    pub(super) fn number_in(&self, word: &str, next_step: &str) -> Result<f64> {
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(self.fail(format!("expected finite numbers, found {word}; calibrate again"))),
            Err(_) => Err(self.fail(format!("expected a number, found \"{word}\"; {next_step}"))),
        }
    }

    /// The size of an image in pixels, from the two words at position `from`.
    pub(super) fn size(&self, from: usize) -> Result<(u32, u32)> {
        // Some programs write sizes as floats, 6.4000000e+02.
        let side = |at: usize| pixels(self.words.get(at)?.parse().ok()?);

        match (side(from), side(from + 1)) {
            (Some(width), Some(height)) => Ok((width, height)),
            _ => {
                let found = self.words.get(from..).unwrap_or_default();
                let found = found[..found.len().min(2)].join(" ");
                Err(self.fail(format!("expected width and height in pixels, found \"{found}\"; write both")))
            }
        }
    }

    pub(super) fn fail(&self, problem: impl std::fmt::Display) -> Error {
        Error::argument(format!("line {}: {problem}", self.number))
    }
}

/// Checks that no two cameras have the same name; `line` maps a camera's position to its line.
///
/// # Errors
/// Two equal names; the message has both lines.
pub(super) fn distinct<'a>(
    names: impl IntoIterator<Item = &'a str>,
    line: impl Fn(usize) -> usize,
) -> Result<()> {
    let mut index_by_name = HashMap::new();
    for (i, name) in names.into_iter().enumerate() {
        if let Some(first) = index_by_name.insert(name, i) {
            let problem = format!(
                "line {}: expected unique names, found this one on line {} too; rename one of them",
                line(i),
                line(first)
            );
            return Err(Error::camera(name, problem));
        }
    }

    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_their_numbers_past_empty_ones() {
        let found: Vec<_> = lines("\u{feff}a b\n\n  \r\n1 2\r\n").map(|l| (l.number, l.words)).collect();
        assert_eq!(found, [(1, vec!["a", "b"]), (4, vec!["1", "2"])]);
    }

    #[test]
    fn numbers_are_counted_and_finite() {
        let line = |text: &'static str| lines(text).next().unwrap();
        assert_eq!(line("x 1 -2e3").numbers::<2>(1, "-").unwrap(), [1.0, -2000.0]);
        let message = |text| line(text).numbers::<2>(0, "write two").unwrap_err().to_string();
        assert_eq!(message("1"), "line 1: expected 2 numbers, found 1; write two");
        assert_eq!(message("1 2 3"), "line 1: expected 2 numbers, found 3; write two");
        assert_eq!(message("1 NaN"), "line 1: expected finite numbers, found NaN; calibrate again");
        assert_eq!(message("1 b"), "line 1: expected a number, found \"b\"; write two");
    }

    #[test]
    fn a_size_is_two_whole_numbers_above_zero() {
        let size = |text: &'static str| lines(text).next().unwrap().size(0);
        assert_eq!(size("640 4.8e2 1").unwrap(), (640, 480));
        for bad in ["640", "640 0", "640 480.5", "640 x", "-640 480", "1e99 2"] {
            assert!(size(bad).unwrap_err().to_string().contains("expected width and height"), "{bad}");
        }
    }
}
