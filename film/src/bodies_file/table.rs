//! One table of the file, with its place for error messages.

use ode_visual_hull::shape::{MIN_SIZE, REACH};
use ode_visual_hull::{Error, Result};
use std::fmt::Display;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table, and where it is.
pub(super) struct Table<'a> {
    text: &'a str,
    /// As `body 2, part 1`; empty for the file itself.
    place: String,
    /// The byte offset of the table in the text.
    start: usize,
    entries: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    /// The whole file.
    pub(super) fn of_file(text: &'a str, entries: &'a DeTable<'a>) -> Self {
        Self { text, place: String::new(), start: 0, entries }
    }

    /// The tables under `key`, `[[key]]` in the file, which messages call `one` with their number; none if it is missing.
    pub(super) fn tables(&self, key: &str, one: &str) -> Result<Vec<Table<'a>>> {
        let Some(entry) = self.entry(key) else { return Ok(Vec::new()) };
        let next = format!("begin each {one} with a line [[{key}]]");
        let array = array(entry.get_ref())
            .ok_or_else(|| self.refuse(key, format!("tables, found {}", found(entry.get_ref())), &next))?;
        let table = |(i, value): (usize, &'a Spanned<DeValue<'a>>)| {
            let DeValue::Table(entries) = value.get_ref() else {
                return Err(self.refuse(key, format!("tables, found {}", found(value.get_ref())), &next));
            };
            let within = if self.place.is_empty() { String::new() } else { format!("{}, ", self.place) };
            let place = format!("{within}{one} {}", i + 1);
            Ok(Self { text: self.text, place, start: value.span().start, entries })
        };
        array.enumerate().map(table).collect()
    }

    /// The table `key`, if there is one.
    pub(super) fn table(&self, key: &str) -> Result<Option<Table<'a>>> {
        let Some(value) = self.entry(key) else { return Ok(None) };
        let DeValue::Table(entries) = value.get_ref() else {
            let next = format!("begin it with a line [{key}]");
            return Err(self.refuse(key, format!("a table, found {}", found(value.get_ref())), &next));
        };
        Ok(Some(Self { text: self.text, place: key.to_owned(), start: value.span().start, entries }))
    }

    /// Refuses fields other than `known`.
    pub(super) fn check_fields(&self, known: &[&str]) -> Result<()> {
        let unknown =
            self.entries.iter().map(|(key, _)| key).find(|key| !known.contains(&key.get_ref().as_ref()));
        let Some(key) = unknown else { return Ok(()) };
        let known: Vec<_> = known.iter().map(|key| format!("`{key}`")).collect();
        let problem = format!("only {}, found another", known.join(", "));
        Err(self.refuse(key.get_ref(), problem, "remove it, or correct its name"))
    }

    /// The field `key`; `next` says what to write where it is missing.
    pub(super) fn field(&self, key: &str, next: &str) -> Result<&'a DeValue<'a>> {
        let entry = self.entry(key).ok_or_else(|| self.refuse(key, "this field, found none", next))?;
        Ok(entry.get_ref())
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.entry(key).is_some()
    }

    pub(super) fn word(&self, key: &str, next: &str) -> Result<&'a str> {
        match self.field(key, next)? {
            DeValue::String(word) => Ok(word),
            other => Err(self.refuse(key, format!("text, found {}", found(other)), next)),
        }
    }

    pub(super) fn flag(&self, key: &str, next: &str) -> Result<bool> {
        match self.field(key, next)? {
            DeValue::Boolean(flag) => Ok(*flag),
            other => Err(self.refuse(key, format!("true or false, found {}", found(other)), next)),
        }
    }

    /// A number that is finite and within [`REACH`].
    pub(super) fn number(&self, key: &str, next: &str) -> Result<f64> {
        let value = self.field(key, next)?;
        let number = number(value).filter(|number| number.abs() <= REACH);
        number.ok_or_else(|| {
            self.refuse(key, format!("a number up to {REACH:e}, found {}", found(value)), next)
        })
    }

    /// `N` such numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str, next: &str) -> Result<[f64; N]> {
        let value = self.field(key, next)?;
        row(value).ok_or_else(|| {
            self.refuse(key, format!("{N} numbers up to {REACH:e}, found {}", found(value)), next)
        })
    }

    /// Any number of such numbers.
    pub(super) fn list(&self, key: &str, next: &str) -> Result<Vec<f64>> {
        self.elements(key, next, "numbers", |value| number(value).filter(|number| number.abs() <= REACH))
    }

    /// Any number of rows of `N` such numbers.
    pub(super) fn rows<const N: usize>(&self, key: &str, next: &str) -> Result<Vec<[f64; N]>> {
        self.elements(key, next, &format!("rows of {N} numbers up to {REACH:e}"), row)
    }

    /// Any number of rows of indices.
    pub(super) fn index_rows(&self, key: &str, next: &str) -> Result<Vec<Vec<u32>>> {
        let indices = |value: &'a DeValue<'a>| {
            array(value)?.map(|index| integer(index.get_ref())?.try_into().ok()).collect()
        };
        self.elements(key, next, "rows of indices from 0 on", indices)
    }

    /// `N` whole numbers that their type holds.
    pub(super) fn whole_numbers<const N: usize, T: TryFrom<i64>>(
        &self,
        key: &str,
        next: &str,
    ) -> Result<[T; N]> {
        let value = self.field(key, next)?;
        let whole = |value: &Spanned<DeValue>| T::try_from(integer(value.get_ref())?).ok();
        let numbers: Option<Vec<T>> = array(value).and_then(|elements| elements.map(whole).collect());
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
            self.refuse(key, format!("{N} whole numbers in range, found {}", found(value)), next)
        })
    }

    /// A length that a shape may have, in metres.
    pub(super) fn length(&self, key: &str) -> Result<f64> {
        let next = "write it in metres";
        let length = number(self.field(key, next)?);
        length
            .filter(|length| (MIN_SIZE..=REACH).contains(length))
            .ok_or_else(|| self.no_length(key, "a length", next))
    }

    /// `N` such lengths.
    pub(super) fn lengths<const N: usize>(&self, key: &str) -> Result<[f64; N]> {
        let next = format!("write {N} of them, in metres");
        let lengths: Option<[f64; N]> = row(self.field(key, &next)?);
        let is_length = |length: &f64| (MIN_SIZE..=REACH).contains(length);
        lengths
            .filter(|lengths| lengths.iter().all(is_length))
            .ok_or_else(|| self.no_length(key, &format!("{N} lengths"), &next))
    }

    fn no_length(&self, key: &str, what: &str, next: &str) -> Error {
        let found = self.entry(key).map_or("none".into(), |value| found(value.get_ref()));
        self.refuse(key, format!("{what} from {MIN_SIZE:e} to {REACH:e} m, found {found}"), next)
    }

    /// The elements of an array, each read by `read`; `what` they have to be.
    fn elements<T>(
        &self,
        key: &str,
        next: &str,
        what: &str,
        read: impl Fn(&'a DeValue<'a>) -> Option<T>,
    ) -> Result<Vec<T>> {
        let value = self.field(key, next)?;
        let elements =
            array(value).ok_or_else(|| self.refuse(key, format!("{what}, found {}", found(value)), next))?;
        let element = |(i, value): (usize, &'a Spanned<DeValue<'a>>)| {
            let wrong = || format!("{what}, found {} as number {i} from 0", found(value.get_ref()));
            read(value.get_ref()).ok_or_else(|| self.refuse(key, wrong(), next))
        };
        elements.enumerate().map(element).collect()
    }

    fn entry(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.entries.iter().find(|(name, _)| name.get_ref().as_ref() == key).map(|(_, value)| value)
    }

    /// The error about a field: what was `expected` and found, and what to do `next`.
    pub(super) fn refuse(&self, key: &str, expected: impl Display, next: &str) -> Error {
        self.problem(key, format!("expected {expected}; {next}"))
    }

    /// The error about a field with a message of its own.
    pub(super) fn problem(&self, key: &str, problem: impl Display) -> Error {
        let line = line_of(self.text, self.entry(key).map_or(self.start, |value| value.span().start));
        let place = if self.place.is_empty() { String::new() } else { format!(", {}", self.place) };
        Error::argument(format!("line {line}{place}, field `{key}`: {problem}"))
    }
}

/// The line of a byte offset, from 1.
pub(super) fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&b| b == b'\n').count()
}

fn array<'a>(value: &'a DeValue<'a>) -> Option<impl Iterator<Item = &'a Spanned<DeValue<'a>>>> {
    match value {
        DeValue::Array(array) => Some(array.iter()),
        _ => None,
    }
}

fn integer(value: &DeValue) -> Option<i64> {
    match value {
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok(),
        _ => None,
    }
}

/// A number, whole or not.
fn number(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => integer(value).map(|whole| whole as f64),
    }
}

/// `N` numbers within [`REACH`].
fn row<const N: usize>(value: &DeValue) -> Option<[f64; N]> {
    let within = |value: &Spanned<DeValue>| number(value.get_ref()).filter(|number| number.abs() <= REACH);
    let numbers: Vec<f64> = array(value)?.map(within).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

/// A value for messages.
fn found(value: &DeValue) -> String {
    match value {
        DeValue::Integer(integer) => integer.as_str().into(),
        DeValue::Float(float) => float.as_str().into(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::String(text) => format!("\"{text}\""),
        DeValue::Array(array) => {
            let shown: Vec<_> = array.iter().take(8).map(|value| found(value.get_ref())).collect();
            let more = if array.iter().count() > 8 { ", .." } else { "" };
            format!("[{}{more}]", shown.join(", "))
        }
        other => format!("a {}", other.type_str()),
    }
}
