//! One camera's masks of all frames in one file, as run lengths.
//!
//! The file begins with a mark. Then come records: a frame's number and the length of what follows in bytes, each as a
//! number of 32 bits, the lower byte first, and a mask as [`PackedMask::encode`] writes it. Of two records of one frame the
//! later one counts; one without any bytes takes the frame's mask away. A mark or a last record that is cut off, as where
//! writing was interrupted, counts as not there.

use crate::silhouette::PackedMask;
use crate::{Error, Result};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What begins the file: its kind and version.
const MARK: [u8; 8] = *b"VHRMASK1";

/// Bytes before a record's mask.
const RECORD: usize = 8;

/// The masks of one camera, which are read when they are asked for.
#[derive(Debug, Clone)]
pub(super) struct MaskFile {
    path: PathBuf,
    /// For each frame where its mask begins, and its length in bytes.
    places: BTreeMap<u32, (u64, u32)>,
    /// Where the next record goes.
    end: u64,
    /// The frame of a last record that is cut off.
    cut_off: Option<u32>,
}

/// Where a mask file ends, and the mask of a frame in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    frame: u32,
    place: Option<(u64, u32)>,
    end: u64,
}

impl MaskFile {
    /// The file at `path`, which need not be there yet.
    ///
    /// # Errors
    /// A file that cannot be read, or that is none of masks.
    pub(super) fn open(path: PathBuf) -> Result<Self> {
        let mut file = Self { path, places: BTreeMap::new(), end: 0, cut_off: None };
        let opened = match File::open(&file.path) {
            Ok(opened) => opened,
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(file),
            Err(e) => return Err(file.unreadable(&e)),
        };
        if file.list(opened).map_err(|e| file.unreadable(&e))? {
            return Ok(file);
        }
        let problem = format!(
            "expected masks as run lengths, which begin with {:?}, found something else; segment again, or move the \
             file away",
            String::from_utf8_lossy(&MARK)
        );
        Err(Error::file(&file.path, problem))
    }

    /// Finds the records; returns whether the file is one of masks.
    fn list(&mut self, file: File) -> io::Result<bool> {
        let length = file.metadata()?.len();
        let mut file = BufReader::new(file);
        let mut mark = Vec::new();
        file.by_ref().take(MARK.len() as u64).read_to_end(&mut mark)?;
        if mark != MARK {
            return Ok(MARK.starts_with(&mark));
        }
        self.end = MARK.len() as u64;
        while self.end + RECORD as u64 <= length {
            let mut record = [0; RECORD];
            file.read_exact(&mut record)?;
            let [frame, bytes] = record.as_chunks().0 else { break };
            let (frame, bytes) = (u32::from_le_bytes(*frame), u32::from_le_bytes(*bytes));
            let start = self.end + RECORD as u64;
            if start + u64::from(bytes) > length {
                self.cut_off = Some(frame);
                break;
            }
            file.seek_relative(i64::from(bytes))?;
            self.place(frame, start, bytes);
        }
        Ok(true)
    }

    /// Takes note of a record.
    fn place(&mut self, frame: u32, start: u64, bytes: u32) {
        match bytes {
            0 => self.places.remove(&frame),
            _ => self.places.insert(frame, (start, bytes)),
        };
        self.end = start + u64::from(bytes);
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The frame whose mask is cut off at the file's end, if any is.
    pub(super) fn cut_off(&self) -> Option<u32> {
        self.cut_off
    }

    /// The frames that have a mask, ascending.
    pub(super) fn frames(&self) -> impl Iterator<Item = u32> {
        self.places.keys().copied()
    }

    pub(super) fn has(&self, frame: u32) -> bool {
        self.places.contains_key(&frame)
    }

    /// The mask of a frame; `None` where it has none.
    ///
    /// # Errors
    /// A file that cannot be read; bytes that are no mask.
    pub(super) fn read(&self, frame: u32) -> Result<Option<PackedMask>> {
        let Some(&(start, length)) = self.places.get(&frame) else { return Ok(None) };
        let mut bytes = vec![0; length as usize];
        let mut read = || {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(start))?;
            file.read_exact(&mut bytes)
        };
        read().map_err(|e| self.unreadable(&e))?;
        let mask = PackedMask::decode(&bytes);
        mask.map(Some).map_err(|e| Error::file(&self.path, format!("frame {frame}: {e}")))
    }

    /// Appends the mask of a frame; without one, takes away what it has.
    ///
    /// # Errors
    /// A mask that is too large to be coded; a file that cannot be written.
    pub(super) fn write(&mut self, frame: u32, mask: Option<&PackedMask>) -> Result<()> {
        let coded = mask.map(PackedMask::encode).transpose()?.unwrap_or_default();
        let mut bytes = Vec::with_capacity(MARK.len() + RECORD + coded.len());
        if self.end == 0 {
            bytes.extend(MARK);
        }
        bytes.extend(frame.to_le_bytes());
        bytes.extend((coded.len() as u32).to_le_bytes());
        bytes.extend(&coded);
        let write = || {
            let mut file = OpenOptions::new().create(true).write(true).truncate(false).open(&self.path)?;
            // What is behind the last whole record was cut off.
            file.set_len(self.end)?;
            file.seek(SeekFrom::End(0))?;
            file.write_all(&bytes)
        };
        write().map_err(|e| Error::unwritten(&self.path, &e))?;
        self.cut_off = None;
        self.place(frame, self.end + (bytes.len() - coded.len()) as u64, coded.len() as u32);
        Ok(())
    }

    /// Where the file stands for a frame, to come back to by [`Self::undo`].
    pub(super) fn state(&self, frame: u32) -> State {
        State { frame, place: self.places.get(&frame).copied(), end: self.end }
    }

    /// Forgets what was written since `state`, which the next record is written over.
    pub(super) fn undo(&mut self, state: State) -> Result<()> {
        self.end = state.end;
        match state.place {
            Some(place) => self.places.insert(state.frame, place),
            None => self.places.remove(&state.frame),
        };
        let file = OpenOptions::new().write(true).open(&self.path);
        file.and_then(|file| file.set_len(self.end)).map_err(|e| Error::unwritten(&self.path, &e))
    }

    fn unreadable(&self, error: &io::Error) -> Error {
        Error::file(&self.path, format!("expected masks as run lengths, found: {error}; check the file"))
    }
}

#[cfg(test)]
mod tests;
