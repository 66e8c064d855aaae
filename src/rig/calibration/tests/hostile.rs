//! Every reader returns a rig or an error for calibrations that are cut off or changed at random.

use super::{Calibration, Hints};
use crate::Result;
use crate::rig::testing::{Folder, HINTS, Sample, several_files, single_files};
use ode_visual_hull_random::Random;

const CUTS: usize = 24;
const MUTATIONS: usize = 60;
/// Mutations of formats in several files, which are written to disk each time.
const MUTATIONS_ON_DISK: usize = 40;

/// Replacements of a word: numbers at the ends of their range and beyond, and syntax characters of the notations.
const WORDS: [&str; 20] = [
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "-1e308",
    "1e-170",
    "1e100",
    "1e999",
    "18446744073709551616",
    "4294967295",
    "[",
    "{",
    "}",
    "\"",
    "&a *a",
    "<a>",
    "#",
    "\u{feff}",
    "\u{e9}",
];

/// `bytes` with a few random changes: a bit flipped, a stretch removed or doubled, a byte inserted, a word replaced.
fn mutated(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len().max(1));
        let end = (at + 1 + random.below(40)).min(bytes.len());

        match random.below(6) {
            0 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.below(7)),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let stretch = bytes[at..end].to_vec();
                drop(bytes.splice(end..end, stretch));
            }
            3 => bytes.insert(at, random.below(256) as u8),
            _ => {
                let is_break = |byte: &u8| !(byte.is_ascii_alphanumeric() || b".-+_".contains(byte));
                let start = bytes[..at].iter().rposition(is_break).map_or(0, |gap| gap + 1);

                let end = bytes[at..].iter().position(is_break).map_or(bytes.len(), |gap| at + gap);
                drop(bytes.splice(start..end, WORDS[random.below(WORDS.len())].bytes()));
            }
        }
    }
    bytes
}

/// Asserts that the result is a rig that describes itself, or an error about the file.
#[track_caller]
fn assert_rig_or_error(found: Result<Calibration>, name: &str) {
    match found {
        Ok(found) => assert_eq!(found.rig.describe().lines().count(), found.rig.len()),
        Err(e) => assert!(e.to_string().starts_with(name), "{e}"),
    }
}

#[test]
fn a_calibration_cut_off_anywhere_is_a_rig_or_an_error() {
    for Sample { name, text } in single_files() {
        for cut in 0..CUTS {
            let bytes = &text.as_bytes()[..text.len() * cut / CUTS];
            assert_rig_or_error(Calibration::parse(name, bytes, &HINTS), name);
            assert_rig_or_error(Calibration::parse(name, bytes, &Hints::default()), name);
        }
    }
}

#[test]
fn a_calibration_changed_at_random_is_a_rig_or_an_error() {
    let mut random = Random(1);
    for Sample { name, text } in single_files() {
        for _ in 0..MUTATIONS {
            assert_rig_or_error(
                Calibration::parse(name, &mutated(text.as_bytes(), &mut random), &HINTS),
                name,
            );
        }
    }
}

#[test]
fn a_folder_with_a_file_changed_at_random_is_a_rig_or_an_error() {
    let mut random = Random(2);
    for files in several_files() {
        let folder = Folder::new();
        let path = folder.path().display().to_string();
        for _ in 0..MUTATIONS_ON_DISK {
            for (name, text) in files {
                std::fs::write(folder.path().join(name), text).unwrap();
            }

            let (name, text) = files[random.below(files.len())];
            std::fs::write(folder.path().join(name), mutated(text.as_bytes(), &mut random)).unwrap();
            assert_rig_or_error(Calibration::load(folder.path(), &HINTS), &path);
        }
    }
}
