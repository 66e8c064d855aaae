//! Images in a folder, one file each.

use super::{Frame, ReadOptions, Source, Times};
use crate::{Error, Result, image_file};
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};

/// The images of a folder whose names are numbers (`000000.png`), in the order of the numbers.
///
/// A file that cannot be read is one error; reading continues with the next file.
#[derive(Debug)]
pub struct ImageFolder {
    files: VecDeque<(u32, PathBuf)>,
    options: ReadOptions,
    times: Times,
}

impl ImageFolder {
    /// Opens the images in `folder`: png, jpeg or pnm.
    ///
    /// # Errors
    /// A folder that cannot be read, holds no numbered images, or holds two of the same number; a rate that is not
    /// positive.
    pub fn open(folder: impl AsRef<Path>, options: ReadOptions) -> Result<Self> {
        let folder = folder.as_ref();
        let files = image_file::numbered(folder, &[""])?;
        if files.is_empty() {
            let problem =
                "expected images whose names are numbers, as 000000.png, found none; check the path";
            return Err(Error::file(folder, problem));
        }
        Self::of_files(files, options)
    }

    /// The images in `files`, keyed by their numbers.
    pub(crate) fn of_files(files: BTreeMap<u32, PathBuf>, options: ReadOptions) -> Result<Self> {
        let times = options.times.clone().unwrap_or(Times::Rate(30.0));
        times.check()?;
        let files = files.into_iter().filter(|(number, _)| *number >= options.first).collect();
        Ok(Self { files, options, times })
    }

    fn read(&self, number: u32, path: &Path) -> Result<Frame> {
        let image = image_file::read(path)?.into_rgb8();
        self.options.check_size(path, "", image.dimensions())?;
        let time = self.times.of(number).map_err(|problem| Error::file(path, problem))?;
        Ok(Frame { number, time, image: image.into() })
    }
}

impl Source for ImageFolder {
    fn next_frame(&mut self) -> Option<Result<Frame>> {
        let (number, path) = self.files.pop_front()?;
        Some(self.read(number, &path))
    }

    fn frames_left(&self) -> Option<u32> {
        u32::try_from(self.files.len()).ok()
    }

    fn period(&self) -> Option<f64> {
        self.times.period()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Folder, assert_says, grey_image};
    use super::*;

    #[test]
    fn images_come_in_the_order_of_their_numbers_with_their_times() {
        let folder = Folder::new("order");
        for number in [10_u32, 9, 100, 2] {
            grey_image(number as u8, (8, 6)).save(folder.path(&format!("{number}.png"))).unwrap();
        }
        std::fs::write(folder.path("notes.txt"), "").unwrap();

        let options = ReadOptions { size: Some((8, 6)), first: 9, times: Some(Times::Rate(10.0)) };
        let mut source = ImageFolder::open(folder.path(""), options).unwrap();
        assert_eq!(source.frames_left(), Some(3));
        for number in [9_u32, 10, 100] {
            let frame = source.next_frame().unwrap().unwrap();
            assert_eq!((frame.number, frame.time), (number, f64::from(number) / 10.0));
            assert_eq!(*frame.image, grey_image(number as u8, (8, 6)));
        }
        assert!(source.next_frame().is_none());
    }

    #[test]
    fn a_corrupt_image_in_the_middle_is_named_and_the_others_are_read() {
        let folder = Folder::new("corrupt");
        for number in 0..4 {
            grey_image(number, (80, 60)).save(folder.path(&format!("{number:06}.png"))).unwrap();
        }

        let png = std::fs::read(folder.path("000001.png")).unwrap();
        std::fs::write(folder.path("000001.png"), &png[..png.len() / 2]).unwrap();
        grey_image(2, (60, 80)).save(folder.path("000002.png")).unwrap();

        let options = ReadOptions { size: Some((80, 60)), ..ReadOptions::default() };
        let mut source = ImageFolder::open(folder.path(""), options).unwrap();
        assert_eq!(source.next_frame().unwrap().unwrap().number, 0);
        assert_says(source.next_frame().unwrap(), &["000001.png", "expected an image"]);
        assert_says(source.next_frame().unwrap(), &["000002.png", "expected 80 x 60", "found 60 x 80"]);
        assert_eq!(source.next_frame().unwrap().unwrap().number, 3);
    }

    #[test]
    fn a_folder_without_images_or_with_a_number_twice_is_refused() {
        let folder = Folder::new("none");
        let open = || ImageFolder::open(folder.path(""), ReadOptions::default());
        assert_says(open(), &["000000.png", "found none"]);
        assert_says(
            ImageFolder::open(folder.path("absent"), ReadOptions::default()),
            &["absent", "found none"],
        );
        grey_image(0, (8, 6)).save(folder.path("1.png")).unwrap();
        grey_image(0, (8, 6)).save(folder.path("01.png")).unwrap();
        assert_says(open(), &["one file for frame 1", "remove one"]);
    }

    #[test]
    fn a_frame_without_a_listed_time_is_an_error_that_names_it() {
        let folder = Folder::new("unlisted");
        for number in [0, 1] {
            grey_image(number, (8, 6)).save(folder.path(&format!("{number}.png"))).unwrap();
        }
        let listed = Times::Listed(std::sync::Arc::new(BTreeMap::from([(1, 5.0)])));
        let options = ReadOptions { times: Some(listed), ..ReadOptions::default() };
        let mut source = ImageFolder::open(folder.path(""), options).unwrap();
        assert_says(source.next_frame().unwrap(), &["0.png", "frame 0", "frames.csv", "frames 1 to 1"]);
        assert_eq!(source.next_frame().unwrap().unwrap().time, 5.0);
        let options = ReadOptions { times: Some(Times::Rate(f64::NAN)), ..ReadOptions::default() };
        assert_says(ImageFolder::open(folder.path(""), options), &["positive", "NaN"]);
    }
}
