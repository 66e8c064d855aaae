//! The table of figures in `docs/performance.md`, between two marker lines.

use crate::session::Row;
use std::fmt::Write;
use std::io;
use std::path::Path;

const BEGIN: &str = "<!-- written by `make bench`: from here -->\n";
const END: &str = "<!-- written by `make bench`: to here -->\n";

/// Replaces the text between the markers by the processor's name and the table of figures.
pub fn write(path: &Path, rows: &[Row]) -> io::Result<()> {
    let page = std::fs::read_to_string(path)?;
    let parts = page.split_once(BEGIN).and_then(|(head, rest)| Some((head, rest.split_once(END)?.1)));
    let Some((head, tail)) = parts else {
        return Err(io::Error::other(format!(
            "{}: expected both marker lines, found at most one; put them back",
            path.display()
        )));
    };
    std::fs::write(path, format!("{head}{BEGIN}{}{END}{tail}", section(rows)))
}

fn section(rows: &[Row]) -> String {
    let mut text = format!("\nProcessor: {}, one core of it.\n\n", cpu());
    text += "| figure | measured | bound | the clock starts at | what |\n|---|--:|--:|---|---|\n";
    for row in rows {
        let bound = row.figure.bound.map(|bound| bound.to_string()).unwrap_or_default();
        let (name, value) = (&row.figure.name, three_digits(row.figure.value));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| `{name}` | {value} | {bound} | {} | {} |", row.start.name(), row.what);
    }
    text + "\n"
}

fn three_digits(value: f64) -> String {
    let digits = 2 - value.abs().max(1e-6).log10().floor() as i32;
    format!("{value:.*}", digits.clamp(0, 9) as usize)
}

/// The processor's name, from the kernel.
fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or("unknown processor".into(), |(_, name)| name.trim().to_owned())
}
