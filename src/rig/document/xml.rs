//! OpenCV's XML as a tree: an element with children is a map, one whose children are all called `_` is a sequence, and
//! words are scalars.
//!
//! Attributes repeat the content and are ignored. Several words in an element are a sequence, as OpenCV writes vectors
//! and the data of matrices; text with spaces is quoted.

use super::{DEEPEST, Node, Value, push, too_deep};
use crate::{Error, Result};

/// Parses a text as XML.
///
/// # Errors
/// Text that is not XML. Messages name the line.
pub(in crate::rig) fn open(text: &str) -> Result<roxmltree::Document<'_>> {
    roxmltree::Document::parse(text).map_err(|e| {
        // The parser gives no position for a text that ends too early.
        let cut = matches!(e, roxmltree::Error::UnexpectedEndOfStream);
        let line = if cut { text.lines().count().max(1) } else { e.pos().row as usize };
        Error::argument(format!(
            "line {line}: expected XML, found: {e}; export the file again, it may be cut off"
        ))
    })
}

/// The content of the root element, which is called `opencv_storage` in OpenCV's files.
pub(super) fn parse(text: &str) -> Result<Node> {
    let document = open(text)?;
    let breaks: Vec<_> = text.bytes().enumerate().filter(|&(_, b)| b == b'\n').map(|(at, _)| at).collect();
    node(&document.root_element(), &breaks, 0)
}

fn node(element: &roxmltree::Node, breaks: &[usize], depth: usize) -> Result<Node> {
    let line = 1 + breaks.partition_point(|&at| at < element.range().start);
    if depth > DEEPEST {
        return Err(too_deep(line));
    }

    let children: Vec<_> = element.children().filter(roxmltree::Node::is_element).collect();
    if children.is_empty() {
        return Ok(Node { line, value: words(element.text().unwrap_or_default(), line) });
    }

    if children.iter().all(|child| child.tag_name().name() == "_") {
        let items = children.iter().map(|child| node(child, breaks, depth + 1)).collect::<Result<_>>()?;
        return Ok(Node { line, value: Value::Sequence(items) });
    }

    let mut entries = Vec::new();
    for child in &children {
        push(&mut entries, child.tag_name().name().to_owned(), node(child, breaks, depth + 1)?)?;
    }
    Ok(Node { line, value: Value::Map(entries) })
}

/// One word is a scalar, several are a sequence. `first_line` is the line of the element.
fn words(text: &str, first_line: usize) -> Value {
    let mut words = Vec::new();
    let (mut rest, mut line) = (text, first_line);
    loop {
        let start = rest.trim_start();
        line += rest[..rest.len() - start.len()].matches('\n').count();
        if start.is_empty() {
            break;
        }

        let (word, after) = match start.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').unwrap_or((quoted, "")),
            None => start.split_at(start.find(char::is_whitespace).unwrap_or(start.len())),
        };
        words.push(Node { line, value: Value::Scalar(word.to_owned()) });
        line += word.matches('\n').count();
        rest = after;
    }

    match words.len() {
        0 => Value::Scalar(String::new()),
        1 => words.swap_remove(0).value,
        _ => Value::Sequence(words),
    }
}
