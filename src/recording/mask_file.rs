//! A file with the masks of all frames of one camera, as run lengths.
//!
//! The file begins with a mark. Records follow: a frame's number and the length of the mask in bytes, each as a
//! little-endian 32-bit number, and the mask as [`PackedMask::encode`] writes it. Of two records of one frame the
//! later one counts; a record of length zero removes the frame's mask. A truncated mark or last record, as after an
//! interrupted write, is ignored.

use crate::silhouette::PackedMask;
use crate::{Error, Result};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The first bytes of the file: its kind and version.
const MARK: [u8; 8] = *b"VHRMASK1";

/// The length of a record's head in bytes.
const RECORD: usize = 8;

/// The masks of one camera, which are read on request.
#[derive(Debug, Clone)]
pub(super) struct MaskFile {
    path: PathBuf,
    /// The start and length in bytes of each frame's mask.
    places: BTreeMap<u32, (u64, u32)>,
    /// The position of the next record.
    end: u64,
    /// The frame of a truncated last record.
    cut_off: Option<u32>,
}

/// The end of a mask file and the place of one frame's mask, to undo a write.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    frame: u32,
    place: Option<(u64, u32)>,
    end: u64,
}

impl MaskFile {
    /// Opens the file at `path`, which may not exist yet.
    ///
    /// # Errors
    /// A file that cannot be read, or is not a mask file.
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

    /// Lists the records; false if the file is not a mask file.
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

    /// Adds a record to the list.
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

    /// The frame of a truncated mask at the end of the file, if any.
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

    /// The mask of a frame, if it has one.
    ///
    /// # Errors
    /// A file that cannot be read; bytes that are not a mask.
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

    /// Appends the mask of a frame; `None` removes its mask.
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

        // {
        let write = || {
            let mut file = OpenOptions::new().create(true).write(true).truncate(false).open(&self.path)?;
            // Remove a truncated last record.
            file.set_len(self.end)?;
            file.seek(SeekFrom::End(0))?;
            file.write_all(&bytes)
        };

        write().map_err(|e| Error::unwritten(&self.path, &e))?;
        self.cut_off = None;
        self.place(frame, self.end + (bytes.len() - coded.len()) as u64, coded.len() as u32);
        Ok(())
    }

    /// The current state for one frame, for [`Self::undo`].
    pub(super) fn state(&self, frame: u32) -> State {
        State { frame, place: self.places.get(&frame).copied(), end: self.end }
    }

    /// Removes the record written since `state`.
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
