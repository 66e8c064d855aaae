//! Figures as a printed table, and in a file that several programs write to.

use crate::figure::{Bound, Figure};
use std::io;
use std::path::Path;

/// Prints one row for each figure, those with a bound first.
pub fn print_table(figures: &[Figure]) {
    let width = figures.iter().map(|figure| figure.name.len()).max().unwrap_or(0);
    println!("{:width$} | {:>10} | {:>16} | ok", "name", "measured", "bound");
    println!("{:-<width$}-|-{:->10}-|-{:->16}-|---", "", "", "");

    let (bounded, free): (Vec<&Figure>, _) = figures.iter().partition(|figure| figure.bound.is_some());
    for figure in bounded.into_iter().chain(free) {
        let bound = figure.bound.as_ref().map(Bound::to_string).unwrap_or_default();
        let ok = match figure.bound {
            Some(_) if figure.holds() => "yes",
            Some(_) => "NO",
            None => "",
        };
        println!("{:width$} | {:>10.5} | {bound:>16} | {ok}", figure.name, figure.value);
    }
}

/// Writes `figures` into the JSON object at `path`, name to number. Figures of other names that the file holds already
/// are kept.
///
/// # Errors
///
/// The file cannot be read or written.
pub fn record(path: &Path, figures: &[Figure]) -> io::Result<()> {
    let before = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
        Err(error) => return Err(error),
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(path, merged(&before, figures))
}

/// The object in `before`, which has one member a line as this function writes them, with `figures` added or replaced.
fn merged(before: &str, figures: &[Figure]) -> String {
    let member = |line: &'_ str| {
        let (name, value) = line.trim().trim_end_matches(',').strip_prefix('"')?.split_once("\": ")?;
        Some((name.to_owned(), value.to_owned()))
    };

    let mut members: Vec<(String, String)> = before.lines().filter_map(member).collect();
    for figure in figures {
        // JSON cannot express NaN; Rust prints any other number as JSON has it, and names need no escapes.
        let value = if figure.value.is_finite() { figure.value.to_string() } else { "null".into() };
        match members.iter_mut().find(|(name, _)| *name == figure.name) {
            Some((_, old)) => *old = value,
            None => members.push((figure.name.clone(), value)),
        }
    }

    let lines: Vec<_> = members.iter().map(|(name, value)| format!("  \"{name}\": {value}")).collect();
    format!("{{\n{}\n}}\n", lines.join(",\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_other_programs_stay_and_those_measured_again_are_replaced() {
        let first = merged("", &[Figure::reported("a", 1.0), Figure::reported("b", f64::NAN)]);
        assert_eq!(first, "{\n  \"a\": 1,\n  \"b\": null\n}\n");
        let second = merged(&first, &[Figure::reported("c", 0.5), Figure::reported("b", -2e-7)]);
        assert_eq!(second, "{\n  \"a\": 1,\n  \"b\": -0.0000002,\n  \"c\": 0.5\n}\n");
    }
}
