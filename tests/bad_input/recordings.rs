//! Recordings with faults.

use super::*;

/// Writes a recording of two frames of the table to `folder`.
fn record_table(folder: &Path) -> Recording {
    let mut recording = Recording::create(folder, &Rig::new(table_cameras()).unwrap()).unwrap();
    recording.write_masks(0, table_masks()).unwrap();
    recording.write_masks(1, table_masks()).unwrap();
    recording
}

#[test]
fn faults_of_a_recording_name_the_file_and_the_view() {
    let folder = Folder::new("recording");
    let dir = folder.path("table");
    let mask = |camera: &str, frame: u32| dir.join(camera).join("mask").join(format!("{frame:06}.png"));
    drop(record_table(&dir));

    // One mask of a frame is broken, has another size, or consists of 0 and 1: the frame before stays in force.
    let png = std::fs::read(mask("cam3", 1)).unwrap();
    let small = GrayImage::new(64, 48);
    let ones = GrayImage::from_pixel(640, 480, Luma([1]));
    let faults: [(&dyn Fn(), &[&str]); 4] = [
        (&|| std::fs::write(mask("cam3", 1), &png[..png.len() / 2]).unwrap(), &["expected an image"]),
        (&|| std::fs::write(mask("cam3", 1), b"").unwrap(), &["expected an image"]),
        (&|| small.save(mask("cam3", 1)).unwrap(), &["640 x 480", "found 64 x 48", "calibrate"]),
        (&|| ones.save(mask("cam3", 1)).unwrap(), &["greatest value of 1", "multiply by 255"]),
    ];

    for (fault, parts) in faults {
        fault();
        let recording = Recording::open(&dir).unwrap();
        let data = data_with(recording.rig().cameras());
        for frame in [0, 1] {
            let masks = match recording.masks(frame) {
                Ok(masks) => masks,
                refused => {
                    let always = ["view \"cam3\"", "000001.png"];
                    assert_says(refused, &[&always[..], parts].concat());
                    continue;
                }
            };
            masks.iter().enumerate().for_each(|(view, mask)| data.set_mask(view, mask).unwrap());
            data.update(f64::from(frame)).unwrap();
        }
        assert_eq!(data.latest().unwrap().1.time(), 0.0);
        assert_table_in_force(&data);
    }

    std::fs::remove_file(mask("cam3", 1)).unwrap();
    let recording = Recording::open(&dir).unwrap();

    assert_eq!(recording.frames(), [0]);
    assert_says(recording.masks(1), &["view \"cam3\"", "cam3/mask/000001", "only frame 0"]);

    std::fs::rename(dir.join("cam2"), dir.join("camera2")).unwrap();
    assert_says(Recording::open(&dir), &["view \"cam2\"", "expected the folder", "found none"]);

    std::fs::remove_file(dir.join("rig.toml")).unwrap();
    assert_says(Recording::open(&dir), &["rig.toml", "found none", "calibration"]);
    assert_says(Recording::open(folder.path("none")), &["none", "folder of a recording", "check the path"]);
}
