//! Reads a video's header with `ffprobe`.

use super::ffmpeg::{cannot_start, file_name, last_lines};
use crate::{Error, Result};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// The header of a video file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Header {
    /// Images per second, if known.
    pub(super) rate: Option<f64>,
    /// The number of images by the header; not every format has it.
    pub(super) frames: Option<u32>,
}

/// Reads the header of the video at `path` without decoding it.
pub(super) fn header(path: &Path) -> Result<Header> {
    let stream = probe(path, "stream=avg_frame_rate,r_frame_rate,nb_frames", &[])?;
    let rate = |key| stream.get(key).and_then(|text| ratio(text));
    // The mean rate comes first: the other one is half the rate for an AVI whose fields count as frames, and the least
    // common multiple for a phone's video with a varying rate.
    let rate = rate("avg_frame_rate").or_else(|| rate("r_frame_rate"));
    Ok(Header { rate, frames: stream.get("nb_frames").and_then(|text| text.parse().ok()) })
}

/// The number of images in the file, decodable or not; reads the whole file.
pub(super) fn packets(path: &Path) -> Result<Option<u32>> {
    let stream = probe(path, "stream=nb_read_packets", &["-count_packets"])?;
    Ok(stream.get("nb_read_packets").and_then(|text| text.parse().ok()))
}

/// The entries of the first video stream, by key.
fn probe(path: &Path, entries: &str, options: &[&str]) -> Result<BTreeMap<String, String>> {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", "v:0"]).args(options).args(["-show_entries", entries]);
    command.args(["-of", "default=noprint_wrappers=1"]).arg(file_name(path));

    let output = command.output().map_err(|e| cannot_start("ffprobe", path, &e))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let keys: BTreeMap<_, _> =
        text.lines().filter_map(|line| line.split_once('=')).map(|(k, v)| (k.into(), v.into())).collect();
    if output.status.success() && !keys.is_empty() {
        return Ok(keys);
    }

    let messages = last_lines(&output.stderr[..]);
    let found = if messages.is_empty() { "no stream of images".into() } else { messages.join("; ") };
    Err(Error::file(path, format!("expected a video that ffmpeg can read, found: {found}")))
}

/// Parses a ratio such as `30000/1001`; `None` for `0/0`, which means unknown.
fn ratio(text: &str) -> Option<f64> {
    let (above, below) = text.split_once('/')?;
    let ratio = above.parse::<f64>().ok()? / below.parse::<f64>().ok()?;
    (ratio.is_finite() && ratio > 0.0).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_ratios_and_zero_by_zero_is_none() {
        assert_eq!(ratio("25/1"), Some(25.0));
        assert_eq!(ratio("30000/1001"), Some(30000.0 / 1001.0));
        for text in ["0/0", "1/0", "0/1", "", "25"] {
            assert_eq!(ratio(text), None, "{text}");
        }
    }
}
