//! YAML, and JSON with it, as trees.
//!
//! OpenCV's dialect differs in its first line, `%YAML:1.0`, which is no directive of YAML's; its private tag
//! `!!opencv-matrix` is passed over with all other tags. Of several documents in a file the first is read.

use super::{DEEPEST, Node, Value, push, too_deep};
use crate::{Error, Result};
use saphyr_parser::{Event, Parser, Span, StrInput};
use std::borrow::Cow;
use std::collections::HashMap;

/// How large a document may be once its aliases are written out, as [`size`] counts.
const MOST_NODES: usize = 1 << 20;

/// Bytes of text that take as much memory as a node.
const NODE_BYTES: usize = 64;

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

/// The text with its first line emptied where that is a directive `%YAML`, in whatever spelling.
fn without_directive(text: &str) -> Cow<'_, str> {
    match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => Cow::Owned(format!("\n{rest}")),
        _ => Cow::Borrowed(text),
    }
}

struct Reader<'a> {
    parser: Parser<'a, StrInput<'a>>,
    lines: usize,
    /// What aliases stand for, by the parser's number.
    anchors: HashMap<usize, Node>,
    nodes: usize,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Result<(Event<'a>, Span)> {
        match self.parser.next_event() {
            Some(Ok(event)) => Ok(event),
            Some(Err(e)) => Err(Error::argument(format!(
                "line {}: expected YAML or JSON, found: {}; the file may be cut off, or be of another kind",
                // The parser sees an end that comes too soon on a line of its own.
                e.marker().line().min(self.lines),
                e.info()
            ))),
            None => Ok((Event::StreamEnd, Span::default())),
        }
    }

    /// The root, and behind it nothing or another document.
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
            // A block's own line would be that of its first entry.
            let value = Node { line, ..self.node(event, span, depth + 1)? };
            push(&mut entries, key, value)?;
        }
    }

    /// What an alias stands for. An anchor that holds itself is not known yet, and refused like an unknown one.
    fn alias(&mut self, anchor: usize, line: usize) -> Result<Node> {
        let Some(node) = self.anchors.get(&anchor).cloned() else {
            let problem = "expected an alias of something above, found one of itself; write the value out";
            return Err(Error::argument(format!("line {line}: {problem}")));
        };
        self.count(size(&node), line)?;
        Ok(node)
    }

    fn count(&mut self, more: usize, line: usize) -> Result<()> {
        self.nodes += more;
        if self.nodes <= MOST_NODES {
            return Ok(());
        }
        let problem = format!("expected a calibration, found more than {MOST_NODES} values; check the file");
        Err(Error::argument(format!("line {line}: {problem}")))
    }
}

/// The nodes of a tree, and its texts in nodes of the same memory.
fn size(node: &Node) -> usize {
    match &node.value {
        Value::Scalar(text) => 1 + text.len() / NODE_BYTES,
        Value::Sequence(items) => 1 + items.iter().map(size).sum::<usize>(),
        Value::Map(entries) => {
            1 + entries.iter().map(|(key, node)| key.len() / NODE_BYTES + size(node)).sum::<usize>()
        }
    }
}
