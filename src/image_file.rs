//! Reads and writes image files with the crate's errors.

use crate::{Error, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat, ImageReader, PixelWithColorType};
use std::collections::{BTreeMap, VecDeque};
use std::fs::File;
use std::io::{BufReader, Cursor};
use std::ops::Deref;
use std::path::{Path, PathBuf};

const EXTENSIONS: [&str; 6] = ["png", "jpg", "jpeg", "pgm", "ppm", "pnm"];

/// Reads an image file. The content, not the name, determines the format.
pub(crate) fn read(path: &Path) -> Result<DynamicImage> {
    open(path)?.decode().map_err(|e| unreadable(path, &e))
}

/// Width and height of an image file in pixels, from its header.
pub(crate) fn size(path: &Path) -> Result<(u32, u32)> {
    open(path)?.into_dimensions().map_err(|e| unreadable(path, &e))
}

fn open(path: &Path) -> Result<ImageReader<BufReader<File>>> {
    ImageReader::open(path).and_then(ImageReader::with_guessed_format).map_err(|e| unreadable(path, &e))
}

/// The error about a file that is not an image.
fn unreadable(path: &Path, found: &dyn std::fmt::Display) -> Error {
    Error::file(
        path,
        format!("expected an image (png, jpeg or pnm), found: {found}; replace it by an intact one"),
    )
}

/// Writes a PNG atomically: to a temporary name first, which readers ignore.
pub(crate) fn write_png<P, C>(path: &Path, image: &ImageBuffer<P, C>) -> Result<()>
where
    P: PixelWithColorType<Subpixel = u8> + Sync,
    C: Deref<Target = [u8]> + Sync,
{
    write_pngs([(path, image)])
}

/// Writes several PNGs: all of them, or none if one cannot be written. Each is encoded on a thread of its own, which takes
/// longer than all else.
pub(crate) fn write_pngs<'a, P, C>(
    files: impl IntoIterator<Item = (&'a Path, &'a ImageBuffer<P, C>)>,
) -> Result<()>
where
    P: PixelWithColorType<Subpixel = u8> + Sync + 'a,
    C: Deref<Target = [u8]> + Sync + 'a,
{
    let encoded = std::thread::scope(|scope| {
        let encode = |(path, image)| (path, scope.spawn(move || encoded(path, image)));
        let threads: Vec<_> = files.into_iter().map(encode).collect();
        threads
            .into_iter()
            .map(|(path, thread)| {
                let bytes = thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
                Ok((path, bytes))
            })
            .collect::<Result<Vec<_>>>()
    })?;

    let mut parts = Parts::default();
    encoded.iter().try_for_each(|(path, bytes)| parts.write(path, bytes))?;
    parts.persist()
}

/// The bytes of the PNG of `image`, which will be written to `path`.
fn encoded<P, C>(path: &Path, image: &ImageBuffer<P, C>) -> Result<Vec<u8>>
where
    P: PixelWithColorType<Subpixel = u8>,
    C: Deref<Target = [u8]>,
{
    let mut bytes = Cursor::new(Vec::new());
    let written = image.write_to(&mut bytes, ImageFormat::Png);
    written.map_err(|e| Error::file(path, format!("expected to write a png, found: {e}")))?;
    Ok(bytes.into_inner())
}

/// Files written under temporary names. Those that are not renamed in the end are removed.
#[derive(Default)]
struct Parts(VecDeque<(PathBuf, PathBuf)>);

impl Parts {
    fn write(&mut self, path: &Path, bytes: &[u8]) -> Result<()> {
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        let part = PathBuf::from(part);
        self.0.push_back((part.clone(), path.to_owned()));
        std::fs::write(&part, bytes).map_err(|e| Error::unwritten(path, &e))
    }

    fn persist(mut self) -> Result<()> {
        while let Some((part, path)) = self.0.front() {
            std::fs::rename(part, path).map_err(|e| Error::unwritten(path, &e))?;
            self.0.pop_front();
        }
        Ok(())
    }
}

impl Drop for Parts {
    fn drop(&mut self) {
        for (part, _) in &self.0 {
            // Fails if the file could not be created.
            let _ = std::fs::remove_file(part);
        }
    }
}

/// The image files of a folder whose names are a number and one of the suffixes, by number; empty if there is no such
/// folder.
pub(crate) fn numbered(folder: &Path, suffixes: &[&str]) -> Result<BTreeMap<u32, PathBuf>> {
    let mut files = BTreeMap::new();
    if !folder.is_dir() {
        return Ok(files);
    }

    let fail = |e: std::io::Error| Error::file(folder, format!("expected a readable folder, found: {e}"));
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        let Some(frame) = suffixes.iter().find_map(|suffix| frame_of(&path, suffix)) else { continue };
        if let Some(other) = files.insert(frame, path.clone()) {
            let problem =
                format!("expected one file for frame {frame}, found also {}; remove one", other.display());
            return Err(Error::file(path, problem));
        }
    }
    Ok(files)
}

/// The number in the name of an image file.
fn frame_of(path: &Path, suffix: &str) -> Option<u32> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    let stem = path.file_stem()?.to_str()?.strip_suffix(suffix)?;
    let numbered = stem.bytes().all(|b| b.is_ascii_digit());
    (numbered && EXTENSIONS.contains(&extension.as_str())).then(|| stem.parse().ok())?
}
