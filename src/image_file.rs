//! Image files, read and written with the crate's errors.

use crate::{Error, Result};
use image::{DynamicImage, ImageBuffer, ImageFormat, ImageReader, PixelWithColorType};
use std::fs::File;
use std::io::BufReader;
use std::ops::Deref;
use std::path::Path;

/// The image in a file; its content, not its name, says in which format it is.
pub(crate) fn read(path: &Path) -> Result<DynamicImage> {
    open(path)?.decode().map_err(|e| none(path, &e))
}

/// Width and height of the image in a file, from its header.
pub(crate) fn size(path: &Path) -> Result<(u32, u32)> {
    open(path)?.into_dimensions().map_err(|e| none(path, &e))
}

fn open(path: &Path) -> Result<ImageReader<BufReader<File>>> {
    ImageReader::open(path).and_then(ImageReader::with_guessed_format).map_err(|e| none(path, &e))
}

fn none(path: &Path, found: &dyn std::fmt::Display) -> Error {
    Error::file(path, format!("expected an image (png, jpeg or pnm), found: {found}"))
}

/// Writes a PNG.
pub(crate) fn write_png<P, C>(path: &Path, image: &ImageBuffer<P, C>) -> Result<()>
where
    P: PixelWithColorType<Subpixel = u8>,
    C: Deref<Target = [u8]>,
{
    image
        .save_with_format(path, ImageFormat::Png)
        .map_err(|e| Error::file(path, format!("expected to write a png, found: {e}")))
}
