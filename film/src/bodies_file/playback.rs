//! The table `playback`: how the recording of a run was played.

use super::table::Table;
use crate::arguments::{Movement, VolumeOptions, parse_frames, shown_frames};
use crate::playback_options::PlaybackOptions;
use clap::ValueEnum;
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::hull::{Aabb, Motion};
use std::fmt::Write;

/// How the recording of a run was played, so that the same recorded frame is shown at the same time of the film again.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayedRecording {
    /// Which frames, and when.
    pub options: PlaybackOptions,
    /// How the subject moved between them.
    pub motion: Motion,
}

const FIELDS: [&str; 7] = ["wait", "linger", "frames", "rate", "bounds", "unseen", "motion"];

pub(super) fn read(table: &Table) -> Result<PlayedRecording> {
    table.check_fields(&FIELDS)?;
    let volume = VolumeOptions { bounds: bounds(table)?, unseen: choice(table, "unseen")? };
    let options = PlaybackOptions {
        frames: frames(table)?,
        rate: rate(table)?,
        wait: seconds(table, "wait")?,
        linger: seconds(table, "linger")?,
        volume,
    };
    Ok(PlayedRecording { options, motion: choice::<Movement>(table, "motion")?.motion() })
}

fn seconds(table: &Table, key: &str) -> Result<f64> {
    let next = "write seconds, 0.0 for none";
    let seconds = table.number(key, next)?;
    if seconds < 0.0 {
        return Err(table.refuse(key, format!("seconds from 0 on, found {seconds}"), next));
    }
    Ok(seconds)
}

fn frames(table: &Table) -> Result<Option<std::ops::Range<u32>>> {
    if !table.has("frames") {
        return Ok(None);
    }
    let text = table.word("frames", "write \"A..B\", or leave it out for all")?;
    parse_frames(text).map(Some).map_err(|problem| table.problem("frames", problem))
}

fn rate(table: &Table) -> Result<Option<f64>> {
    if !table.has("rate") {
        return Ok(None);
    }
    let next = "write the recorded images a second, or leave it out where the recording tells them";
    let rate = table.number("rate", next)?;
    if rate <= 0.0 {
        return Err(table.refuse("rate", format!("a rate above 0, found {rate}"), next));
    }
    Ok(Some(rate))
}

fn bounds(table: &Table) -> Result<Option<Aabb>> {
    if !table.has("bounds") {
        return Ok(None);
    }
    let next = "write [x0, x1, y0, y1, z0, z1] in metres, or leave it out";
    let [x0, x1, y0, y1, z0, z1] = table.numbers("bounds", next)?;
    let bounds = Aabb::new(Point3::new(x0, y0, z0), Point3::new(x1, y1, z1));
    bounds.map(Some).map_err(|e| table.problem("bounds", e))
}

/// A value that the command line knows by the same word.
fn choice<T: ValueEnum>(table: &Table, key: &str) -> Result<T> {
    let words: Vec<_> = T::value_variants().iter().map(word).collect();
    let next = format!("write {key} = \"{}\" or another of them", words[0]);
    let found = table.word(key, &next)?;
    T::from_str(found, false)
        .map_err(|_| table.refuse(key, format!("one of {}, found \"{found}\"", words.join(", ")), &next))
}

fn word<T: ValueEnum>(value: &T) -> String {
    value.to_possible_value().map_or(String::new(), |possible| possible.get_name().to_owned())
}

/// The text of the table.
pub(super) fn write(played: &PlayedRecording) -> String {
    let PlaybackOptions { frames, rate, wait, linger, volume } = &played.options;
    let mut text = format!("[playback]\nwait = {wait:?}\nlinger = {linger:?}\n");
    if let Some(frames) = frames {
        let _ = writeln!(text, "frames = \"{}\"", shown_frames(frames));
    }
    if let Some(rate) = rate {
        let _ = writeln!(text, "rate = {rate:?}");
    }
    if let Some(Aabb { min, max }) = volume.bounds {
        let _ = writeln!(text, "bounds = {:?}", [min.x, max.x, min.y, max.y, min.z, max.z]);
    }
    let movement = Movement::value_variants().iter().find(|movement| movement.motion() == played.motion);
    let motion = movement.map_or(String::new(), word);
    let _ = writeln!(text, "unseen = \"{}\"\nmotion = \"{motion}\"", word(&volume.unseen));
    text
}
