use super::super::tests::Folder;
use super::*;
use image::{GrayImage, Luma};

fn mask(value: u8) -> PackedMask {
    PackedMask::new(&GrayImage::from_fn(70, 9, |x, _| Luma([if x < 30 { value } else { 0 }])))
}

#[test]
fn masks_are_read_back_and_the_last_one_of_a_frame_counts() {
    let folder = Folder::new("mask-file");
    let path = folder.join("mask.rle");
    let mut file = MaskFile::open(path.clone()).unwrap();
    for (frame, value) in [(3, 255), (9, 200), (3, 140), (11, 255)] {
        file.write(frame, Some(&mask(value))).unwrap();
    }
    file.write(11, None).unwrap();
    for file in [file, MaskFile::open(path).unwrap()] {
        assert_eq!(file.frames().collect::<Vec<_>>(), [3, 9]);
        assert_eq!(file.read(3).unwrap(), Some(mask(140)));
        assert_eq!(file.read(9).unwrap(), Some(mask(200)));
        assert_eq!(file.read(11).unwrap(), None);
    }
}

#[test]
fn a_truncated_last_mask_is_ignored_and_overwritten() {
    let folder = Folder::new("mask-file-cut");
    let path = folder.join("mask.rle");
    let mut file = MaskFile::open(path.clone()).unwrap();
    file.write(0, Some(&mask(255))).unwrap();
    let complete = std::fs::metadata(&path).unwrap().len();
    file.write(1, Some(&mask(200))).unwrap();

    let bytes = std::fs::read(&path).unwrap();
    for length in 0..MARK.len() {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let mut file = MaskFile::open(path.clone()).unwrap();
        assert_eq!(file.frames().count(), 0, "{length}");
        file.write(2, Some(&mask(140))).unwrap();
        assert_eq!(MaskFile::open(path.clone()).unwrap().read(2).unwrap(), Some(mask(140)), "{length}");
    }

    for length in complete as usize + 1..bytes.len() {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let mut file = MaskFile::open(path.clone()).unwrap();
        assert_eq!(file.frames().collect::<Vec<_>>(), [0], "{length}");
        file.write(2, Some(&mask(140))).unwrap();
        let file = MaskFile::open(path.clone()).unwrap();
        assert_eq!(file.read(2).unwrap(), Some(mask(140)), "{length}");
    }
}

#[test]
fn other_files_and_damaged_masks_are_refused_by_name() {
    let folder = Folder::new("mask-file-bad");
    let path = folder.join("mask.rle");
    for content in [&b"VHRX"[..], b"VHRMASK2", b"\x89PNG\r\n\x1a\n...."] {
        std::fs::write(&path, content).unwrap();
        let message = MaskFile::open(path.clone()).unwrap_err().to_string();
        assert!(message.contains("mask.rle") && message.contains("VHRMASK1"), "{message}");
    }

    std::fs::remove_file(&path).unwrap();
    MaskFile::open(path.clone()).unwrap().write(5, Some(&mask(255))).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    bytes[MARK.len() + RECORD + 4] = 7;
    std::fs::write(&path, &bytes).unwrap();
    let message = MaskFile::open(path).unwrap().read(5).unwrap_err().to_string();
    assert!(
        message.contains("mask.rle") && message.contains("frame 5") && message.contains("flags"),
        "{message}"
    );

    let missing = MaskFile::open(folder.join("none/mask.rle")).unwrap().write(0, Some(&mask(255)));
    assert!(missing.unwrap_err().to_string().contains("mask.rle"));
}
