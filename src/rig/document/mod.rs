//! A calibration document of whatever notation as one tree: YAML, JSON and OpenCV's XML.
//!
//! Every node keeps its line, so that errors about a value name it. JSON goes through the YAML parser (YAML 1.2
//! contains it), which keeps lines too.

mod entry;
mod xml;
mod yaml;

pub(super) use entry::Entry;
pub(super) use xml::open as open_xml;

use crate::{Error, Result};

/// How deep documents may nest: calibrations do not come near it, and no stack ends before it.
const DEEPEST: usize = 32;

/// How many keys a map may have: each key is compared with all before it, and readers look for theirs among all.
const MOST_KEYS: usize = 1 << 12;

/// A value and the line on which it starts, from 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub(super) line: usize,
    pub(super) value: Value,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// A number or a text, as written but without quotes.
    Scalar(String),
    Sequence(Vec<Node>),
    /// In the document's order; keys are unique.
    Map(Vec<(String, Node)>),
}

/// Reads XML where the text begins as such, else YAML or JSON.
///
/// # Errors
/// Text that is none of these, or nests too deeply, or has a key twice or too many; with the line.
pub(super) fn parse(text: &str) -> Result<Node> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim_start().starts_with('<') { xml::parse(text) } else { yaml::parse(text) }
}

impl Node {
    /// The entries of a map; none of anything else.
    pub(super) fn entries(&self) -> impl Iterator<Item = Entry<'_>> {
        let entries = match &self.value {
            Value::Map(entries) => entries.as_slice(),
            _ => &[],
        };
        entries.iter().map(|(key, node)| Entry { key: key.into(), node })
    }

    /// The entry called `key`.
    pub(super) fn entry(&self, key: &str) -> Option<Entry<'_>> {
        self.entries().find(|entry| entry.key == key)
    }

    /// The entry called `key`; else an error that lists what there is, and ends in `next_step`.
    pub(super) fn require(&self, key: &str, next_step: &str) -> Result<Entry<'_>> {
        let fail = || Error::argument(format!("line {}: {}", self.line, self.missing(key, next_step)));
        self.entry(key).ok_or_else(fail)
    }

    fn missing(&self, key: &str, next_step: &str) -> String {
        format!("expected the key `{key}`, found {}; {next_step}", self.outline())
    }

    /// What it is, for people: the first keys of a map.
    pub(super) fn outline(&self) -> String {
        match &self.value {
            Value::Scalar(text) if text.is_empty() => "nothing".into(),
            Value::Scalar(text) => format!("\"{}\"", text.chars().take(40).collect::<String>()),
            Value::Sequence(items) => format!("a list of {}", items.len()),
            Value::Map(entries) => {
                let keys: Vec<_> = entries.iter().take(8).map(|(key, _)| key.as_str()).collect();
                let more = if entries.len() > keys.len() { ", ..." } else { "" };
                format!("the keys {}{more}", keys.join(", "))
            }
        }
    }
}

/// Adds an entry to a map under construction, unless its key is there already.
fn push(entries: &mut Vec<(String, Node)>, key: String, node: Node) -> Result<()> {
    if let Some((_, first)) = entries.iter().find(|(other, _)| *other == key) {
        return Err(Error::argument(format!(
            "line {}: expected each key once, found `{key}` again, first on line {}; rename or remove one",
            node.line, first.line
        )));
    }
    if entries.len() == MOST_KEYS {
        return Err(Error::argument(format!(
            "line {}: expected a calibration, found a map of more than {MOST_KEYS} keys; check the file",
            node.line
        )));
    }
    entries.push((key, node));
    Ok(())
}

fn too_deep(line: usize) -> Error {
    Error::argument(format!(
        "line {line}: expected a calibration, found a document that nests more than {DEEPEST} deep; check the file"
    ))
}

#[cfg(test)]
mod tests;
