//! A calibration document as a tree, from YAML, JSON or OpenCV's XML.
//!
//! Every node keeps its line, so that errors about a value can name it. JSON is parsed as YAML, which contains it
//! since YAML 1.2, to keep lines too.

mod entry;
mod xml;
mod yaml;

pub(super) use entry::Entry;
pub(super) use xml::open as open_xml;

use crate::{Error, Result};

/// The deepest nesting of a document: calibrations nest far less, and recursion to this depth fits any stack.
const DEEPEST: usize = 32;

/// The most keys of a map: searching for a key and checking for duplicates take time linear in their number.
const MOST_KEYS: usize = 1 << 12;

/// A value and the line on which it starts, from 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    pub(super) line: usize,
    pub(super) value: Value,
}

#[derive(Debug, Clone, PartialEq)]
/// The content of a node.
pub(super) enum Value {
    /// A number or a text, as written but without quotes.
    Scalar(String),
    Sequence(Vec<Node>),
    /// Entries in the document's order, with unique keys.
    Map(Vec<(String, Node)>),
}

/// Parses XML if the text begins with `<`, else YAML or JSON.
///
/// # Errors
/// Text that is none of these, nests too deeply, has a key twice or has too many keys. Messages name the line.
pub(super) fn parse(text: &str) -> Result<Node> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim_start().starts_with('<') { xml::parse(text) } else { yaml::parse(text) }
}

impl Node {
    /// The entries of a map; empty for other values.
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

    /// The entry called `key`; else an error that lists the existing keys and ends in `next_step`.
    pub(super) fn require(&self, key: &str, next_step: &str) -> Result<Entry<'_>> {
        let fail = || Error::argument(format!("line {}: {}", self.line, self.missing(key, next_step)));
        self.entry(key).ok_or_else(fail)
    }

    fn missing(&self, key: &str, next_step: &str) -> String {
        format!("expected the key `{key}`, found {}; {next_step}", self.outline())
    }

    /// A short description of the value for messages, such as the first keys of a map.
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
