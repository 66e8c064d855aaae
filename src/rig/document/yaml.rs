//! YAML, and JSON as a part of it, as a tree.
//!
//! OpenCV's first line `%YAML:1.0` is not a valid YAML directive and is removed. Tags such as OpenCV's
//! `!!opencv-matrix` are ignored. If a file holds several documents, the first is read.

use super::{DEEPEST, Node, Value, push, too_deep};
use crate::{Error, Result};
use saphyr_parser::{Event, Parser, Span, StrInput};
use std::borrow::Cow;
use std::collections::HashMap;

/// The largest document after its aliases are expanded, in nodes as counted by [`size`].
const MOST_NODES: usize = 1 << 20;

/// Bytes of text that count as one node.
const NODE_BYTES: usize = 64;

/// Parses the first document of a text.
pub(super) fn parse(text: &str) -> Result<Node> {
    let text = without_directive(text);
    let lines = text.lines().count().max(1);
    let mut reader = Reader { parser: Parser::new_from_str(&text), lines, anchors: HashMap::new(), nodes: 0 };

    loop {
        match reader.next()? {
            (Event::StreamStart | Event::DocumentStart(_) | Event::Nothing, _) => {}
            (Event::StreamEnd | Event::DocumentEnd, span) => {
                let problem = "expected a calibration, found an empty document; check the file";
                return Err(Error::argument(format!("line {}: {problem}", span.start.line())));
            }
            (event, span) => return reader.document(event, span),
        }
    }
}

/// The text with its first line emptied if that is a `%YAML` directive in any spelling.
fn without_directive(text: &str) -> Cow<'_, str> {
    match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => Cow::Owned(format!("\n{rest}")),
        _ => Cow::Borrowed(text),
    }
}

/// Builds the tree from the parser's events.
struct Reader<'a> {
    parser: Parser<'a, StrInput<'a>>,
    /// The number of lines of the text.
    lines: usize,
    /// The anchored nodes, by the parser's number of the anchor.
    anchors: HashMap<usize, Node>,
    nodes: usize,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Result<(Event<'a>, Span)> {
        match self.parser.next_event() {
            Some(Ok(event)) => Ok(event),
            Some(Err(e)) => Err(Error::argument(format!(
                "line {}: expected YAML or JSON, found: {}; the file may be cut off, or be of another kind",
                // For a text that ends too early the parser reports the line after the last.
                e.marker().line().min(self.lines),
                e.info()
            ))),
            None => Ok((Event::StreamEnd, Span::default())),
        }
    }

    /// The root node; after it only another document may follow.
    fn document(&mut self, event: Event<'a>, span: Span) -> Result<Node> {
        let root = self.node(event, span, 0)?;
        loop {
            match self.next()? {
                (Event::DocumentEnd, _) => {}
                (Event::StreamEnd | Event::DocumentStart(true), _) => return Ok(root),
                (_, span) => {
                    let problem =
                        "expected the document to end, found more; remove what does not belong to it";
                    return Err(Error::argument(format!("line {}: {problem}", span.start.line())));
                }
            }
        }
    }

    /// The node that begins with `event`, and all below it.
    fn node(&mut self, event: Event<'a>, span: Span, depth: usize) -> Result<Node> {
        let line = span.start.line();
        if depth > DEEPEST {
            return Err(too_deep(line));
        }

        self.count(1, line)?;

        let (anchor, value) = match event {
            Event::Scalar(text, _, anchor, _) => (anchor, Value::Scalar(text.into_owned())),
            Event::SequenceStart(anchor, _) => (anchor, self.sequence(depth)?),
            Event::MappingStart(anchor, _) => (anchor, self.map(depth)?),
            Event::Alias(anchor) => return self.alias(anchor, line),
            _ => {
                let problem = "expected a value, found the end of the document; the file may be cut off";
                return Err(Error::argument(format!("line {line}: {problem}")));
            }
        };

        let node = Node { line, value };
        if anchor > 0 {
            self.count(size(&node), line)?;
            self.anchors.insert(anchor, node.clone());
        }
        Ok(node)
    }

    fn sequence(&mut self, depth: usize) -> Result<Value> {
        let mut items = Vec::new();
        loop {
            match self.next()? {
                (Event::SequenceEnd, _) => return Ok(Value::Sequence(items)),
                (event, span) => items.push(self.node(event, span, depth + 1)?),
            }
        }
    }

    fn map(&mut self, depth: usize) -> Result<Value> {
        let mut entries = Vec::new();
        loop {
            let (event, span) = self.next()?;
            if event == Event::MappingEnd {
                return Ok(Value::Map(entries));
            }

            let key = self.node(event, span, depth + 1)?;
            let line = key.line;
            let Value::Scalar(key) = key.value else {
                let problem = format!("expected a name as key, found {}; check the file", key.outline());
                return Err(Error::argument(format!("line {line}: {problem}")));
            };

            let (event, span) = self.next()?;
            // The value gets the line of its key: a block's own line would be its first entry's.
            let value = Node { line, ..self.node(event, span, depth + 1)? };
            push(&mut entries, key, value)?;
        }
    }

    /// The node behind an alias. An anchor inside its own node is not known yet and is refused like an unknown one.
    fn alias(&mut self, anchor: usize, line: usize) -> Result<Node> {
        let Some(node) = self.anchors.get(&anchor).cloned() else {
            let problem = "expected an alias of something above, found one of itself; write the value out";
            return Err(Error::argument(format!("line {line}: {problem}")));
        };
        self.count(size(&node), line)?;
        Ok(node)
    }

    /// Counts nodes and refuses documents that are too large, such as nested aliases that grow exponentially.
    fn count(&mut self, more: usize, line: usize) -> Result<()> {
        self.nodes += more;
        if self.nodes <= MOST_NODES {
            return Ok(());
        }
        let problem = format!("expected a calibration, found more than {MOST_NODES} values; check the file");
        Err(Error::argument(format!("line {line}: {problem}")))
    }
}

/// The number of nodes of a tree, with long texts counted as several nodes.
fn size(node: &Node) -> usize {
    match &node.value {
        Value::Scalar(text) => 1 + text.len() / NODE_BYTES,
        Value::Sequence(items) => 1 + items.iter().map(size).sum::<usize>(),
        Value::Map(entries) => {
            1 + entries.iter().map(|(key, node)| key.len() / NODE_BYTES + size(node)).sum::<usize>()
        }
    }
}
