//! The pixels of a packed mask that the subject covers in part.

use std::ops::Range;

/// The bytes of a mask that are neither 0 nor 255, row-major.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::silhouette) struct Coverage {
    /// For each row the number of bytes in all rows up to it.
    ends: Vec<u32>,
    /// The column of each byte.
    columns: Vec<u32>,
    bytes: Vec<u8>,
}

impl Coverage {
    pub(in crate::silhouette) fn restart(&mut self) {
        self.ends.clear();
        self.columns.clear();
        self.bytes.clear();
    }

    /// Whether no pixel is covered in part.
    pub(super) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Appends a byte. Its row is not above the row of the last one.
    #[inline(always)]
    pub(in crate::silhouette) fn push(&mut self, x: usize, y: usize, byte: u8) {
        self.end_rows(y);
        self.columns.push(x as u32);
        self.bytes.push(byte);
    }

    /// Row `y`, which is not above the row of the last byte, with room for `count` more bytes.
    #[inline(always)]
    pub(super) fn begin_row(&mut self, y: usize, count: usize) -> CoverageRow<'_> {
        self.end_rows(y);
        let Self { columns, bytes, .. } = self;
        let end = bytes.len();
        columns.resize(end + count, 0);
        bytes.resize(end + count, 0);
        CoverageRow { columns, bytes, end }
    }

    /// Marks the rows above `y` as complete.
    #[inline(always)]
    pub(in crate::silhouette) fn end_rows(&mut self, y: usize) {
        if self.ends.len() < y {
            self.ends.resize(y, self.bytes.len() as u32);
        }
    }

    /// The columns and bytes of row `y`, ascending by column; empty for a row beyond the image.
    #[inline(always)]
    pub(in crate::silhouette) fn row(&self, y: usize) -> impl Iterator<Item = (usize, u8)> {
        self.columns(y).iter().map(|&x| x as usize).zip(self.bytes(y).iter().copied())
    }

    /// The columns of row `y`, ascending.
    #[inline(always)]
    pub(in crate::silhouette) fn columns(&self, y: usize) -> &[u32] {
        &self.columns[self.range(y)]
    }

    /// The bytes of row `y`, ascending by column.
    #[inline(always)]
    pub(in crate::silhouette) fn bytes(&self, y: usize) -> &[u8] {
        &self.bytes[self.range(y)]
    }

    /// The range of row `y` in `columns` and `bytes`.
    #[inline(always)]
    fn range(&self, y: usize) -> Range<usize> {
        match self.ends.get(..=y) {
            Some([end]) => 0..*end as usize,
            Some([.., start, end]) => *start as usize..*end as usize,
            _ => 0..0,
        }
    }
}

/// The coverage of a row that is being written, without a branch for each byte.
#[derive(Debug)]
pub(in crate::silhouette) struct CoverageRow<'a> {
    columns: &'a mut Vec<u32>,
    bytes: &'a mut Vec<u8>,
    /// Number of bytes so far; the rest is room.
    end: usize,
}

impl CoverageRow<'_> {
    /// Appends a byte where `is_partial`. There is room for it.
    #[inline(always)]
    pub(in crate::silhouette) fn push_if(&mut self, is_partial: bool, x: usize, byte: u8) {
        (self.columns[self.end], self.bytes[self.end]) = (x as u32, byte);
        self.end += usize::from(is_partial);
    }

    /// Completes the row.
    #[inline(always)]
    pub(in crate::silhouette) fn close(self) {
        self.columns.truncate(self.end);
        self.bytes.truncate(self.end);
    }
}
