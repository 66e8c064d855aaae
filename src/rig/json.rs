//! JSON, with what an error message about a value needs: its line and the keys that lead to it.

use crate::{Error, Result};
use serde_core::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::fmt;

/// A value in a document.
#[derive(Clone)]
pub(super) struct Field<'a> {
    document: &'a str,
    raw: &'a RawValue,
    /// `cameras[2].K`; empty for the whole document.
    keys: String,
}

/// An object's entries, in the document's order.
pub(super) struct Object<'a> {
    whole: Field<'a>,
    pub(super) fields: Vec<(String, Field<'a>)>,
}

/// An object's entries as they stand, equal keys included.
struct Entries<'a>(Vec<(String, &'a RawValue)>);

impl<'a> Field<'a> {
    /// The whole document.
    pub(super) fn document(text: &'a str) -> Result<Self> {
        let document = text.trim_start_matches('\u{feff}');
        let raw = serde_json::from_str(document).map_err(|e| {
            let problem = "which is no JSON (NaN is none either); fetch the whole file, or write it again";
            Error::argument(format!("expected JSON, found: {e}, {problem}"))
        })?;
        Ok(Self { document, raw, keys: String::new() })
    }

    /// An object's entries.
    pub(super) fn object(&self) -> Result<Object<'a>> {
        let Ok(Entries(entries)) = serde_json::from_str(self.raw.get()) else {
            return Err(self.expected("an object {\"key\": ...}"));
        };
        let mut fields: Vec<(String, Self)> = Vec::new();
        for (key, raw) in entries {
            let keys = if self.keys.is_empty() { key.clone() } else { format!("{}.{key}", self.keys) };
            let field = Self { document: self.document, raw, keys };
            if let Some((_, first)) = fields.iter().find(|(name, _)| *name == key) {
                let first = first.line();
                return Err(
                    field.fail(format!("expected a key once, found it on line {first} too; rename one"))
                );
            }
            fields.push((key, field));
        }
        Ok(Object { whole: self.clone(), fields })
    }

    /// An array's values.
    pub(super) fn items(&self) -> Result<Vec<Self>> {
        let Ok(items) = serde_json::from_str::<Vec<&RawValue>>(self.raw.get()) else {
            return Err(self.expected("an array [...]"));
        };
        let item = |(i, raw)| Self { document: self.document, raw, keys: format!("{}[{i}]", self.keys) };
        Ok(items.into_iter().enumerate().map(item).collect())
    }

    pub(super) fn string(&self) -> Result<String> {
        serde_json::from_str(self.raw.get()).map_err(|_| self.expected("a string \"...\""))
    }

    pub(super) fn is_true(&self) -> bool {
        self.raw.get() == "true"
    }

    /// A finite number.
    pub(super) fn number(&self) -> Result<f64> {
        // JSON's numbers are written as Rust's.
        match self.raw.get().parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.expected("a finite number")),
        }
    }

    /// Exactly `N` numbers, in one array or in rows of equal length, row by row.
    pub(super) fn numbers<const N: usize>(&self, next_step: &str) -> Result<[f64; N]> {
        let mut numbers = Vec::new();
        self.flatten(&mut numbers)?;
        let found = numbers.len();
        numbers.try_into().map_err(|_| self.fail(format!("expected {N} numbers, found {found}; {next_step}")))
    }

    /// The size of an image.
    pub(super) fn pixels(&self) -> Result<u32> {
        let number = self.number()?;
        if number.fract() != 0.0 || !(1.0..=65_535.0).contains(&number) {
            return Err(self.expected("a size in whole pixels, from 1 to 65535"));
        }
        Ok(number as u32)
    }

    fn flatten(&self, into: &mut Vec<f64>) -> Result<usize> {
        if !self.raw.get().starts_with('[') {
            into.push(self.number()?);
            return Ok(1);
        }
        let mut row = None;
        let before = into.len();
        for item in self.items()? {
            let length = item.flatten(into)?;
            if *row.get_or_insert(length) != length {
                return Err(
                    item.fail("expected rows of equal length, found different ones; write the matrix again")
                );
            }
        }
        Ok(into.len() - before)
    }

    fn expected(&self, what: &str) -> Error {
        let raw = self.raw.get();
        let found: String = raw.chars().take(30).collect();
        let more = if raw.len() > found.len() { " ..." } else { "" };
        self.fail(format!("expected {what}, found {found}{more}; write it so"))
    }

    pub(super) fn fail(&self, problem: impl fmt::Display) -> Error {
        let key = if self.keys.is_empty() { String::new() } else { format!(", key `{}`", self.keys) };
        Error::argument(format!("line {}{key}: {problem}", self.line()))
    }

    pub(super) fn line(&self) -> usize {
        // The raw value is a part of the document.
        let offset = self.raw.get().as_ptr() as usize - self.document.as_ptr() as usize;
        1 + self.document.bytes().take(offset).filter(|&byte| byte == b'\n').count()
    }
}

impl<'a> Object<'a> {
    pub(super) fn line(&self) -> usize {
        self.whole.line()
    }

    /// The value of `key`, if there is one.
    pub(super) fn find(&self, key: &str) -> Option<&Field<'a>> {
        self.fields.iter().find(|(name, _)| name == key).map(|(_, field)| field)
    }

    /// The value of `key`.
    pub(super) fn get(&self, key: &str, next_step: &str) -> Result<&Field<'a>> {
        self.find(key)
            .ok_or_else(|| self.fail(format!("expected a key \"{key}\" here, found none; {next_step}")))
    }

    pub(super) fn fail(&self, problem: impl fmt::Display) -> Error {
        self.whole.fail(problem)
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for Entries<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct Collect;
        impl<'de> Visitor<'de> for Collect {
            type Value = Entries<'de>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(Collect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str =
        "{\"a\": [\n[1, 2],\n[3, 4e0]],\n\"b\": {\"c\": \"x\\ny\", \"d\": [[1], [2, 3]]}, \"e\": [1, 1e999]}";

    fn root() -> Object<'static> {
        Field::document(TEXT).unwrap().object().unwrap()
    }

    fn message<T>(result: Result<T>) -> String {
        result.err().unwrap().to_string()
    }

    #[test]
    fn values_are_found_by_their_keys() {
        let root = root();
        assert_eq!(root.get("a", "").unwrap().numbers("").unwrap(), [1.0, 2.0, 3.0, 4.0]);
        let b = root.get("b", "").unwrap().object().unwrap();
        assert_eq!(b.get("c", "").unwrap().string().unwrap(), "x\ny");
        assert_eq!(root.fields.iter().map(|(key, _)| key.as_str()).collect::<Vec<_>>(), ["a", "b", "e"]);
        assert!(root.find("nothing").is_none());
    }

    #[test]
    fn errors_name_line_and_keys() {
        let root = root();
        let (a, b) = (root.get("a", "").unwrap(), root.get("b", "").unwrap().object().unwrap());
        assert_eq!(
            message(a.numbers::<3>("write x")),
            "line 1, key `a`: expected 3 numbers, found 4; write x"
        );
        let found = "found [\n[1, 2],\n[3, 4e0]]; write it so";
        assert_eq!(message(a.string()), format!("line 1, key `a`: expected a string \"...\", {found}"));
        assert!(message(b.get("z", "add it")).starts_with("line 4, key `b`: expected a key \"z\" here"));
        let ragged = message(b.get("d", "").unwrap().numbers::<3>(""));
        assert!(ragged.starts_with("line 4, key `b.d[1]`: expected rows of equal length"), "{ragged}");
        let infinite = message(root.get("e", "").unwrap().numbers::<2>(""));
        assert_eq!(infinite, "line 4, key `e[1]`: expected a finite number, found 1e999; write it so");
    }

    #[test]
    fn text_that_is_no_json_is_refused_with_its_line() {
        for text in ["{\"a\": \n NaN}", "{\"a\": \n [1, 2", "{\"a\":\n 1} 2"] {
            let message = message(Field::document(text));
            assert!(message.starts_with("expected JSON, found: ") && message.contains("line 2"), "{message}");
        }
        let twice = "{\"a\": 1,\n\"a\": 2}";
        let twice = message(Field::document(twice).unwrap().object());
        assert_eq!(twice, "line 2, key `a`: expected a key once, found it on line 1 too; rename one");
    }
}
