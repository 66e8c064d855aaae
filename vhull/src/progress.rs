//! A progress bar on standard error, hidden where that is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar of `count` steps, labelled `what`.
pub fn bar(count: usize, what: &str) -> ProgressBar {
    let bar = ProgressBar::new(count as u64);

    // The template is a constant; an invalid one falls back to the default style.
    let template = "{msg:12} {bar:32} {pos}/{len}  {elapsed} (about {eta} left)";
    let bar = match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    };
    bar.with_message(what.to_owned())
}
