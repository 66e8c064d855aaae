//! `vhull run` on the command line, with small recordings of known subjects.

use image::{GrayImage, Rgb, RgbImage};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, layout, silhouette};
use ode_visual_hull_film::{
    BodiesFile, FinishedRun, Frames, Playback, PlaybackOptions, STEPS_PER_SECOND, States, UnseenPolicy,
    VolumeOptions,
};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Height of the table's top, in metres.
const TABLE_TOP: f64 = 0.4;

/// Six cameras at the height of the table's top.
fn rig() -> Rig {
    Rig::new(layout::ring(6, 3.0, TABLE_TOP, Point3::new(0.0, 0.0, 0.4), (200, 160), 0.6).unwrap()).unwrap()
}

/// A red solid with its centre at (x, 0, z).
fn placed(solid: Solid, x: f64, z: f64) -> Subject {
    Subject::new(vec![Placed::new(solid, Isometry3::translation(x, 0.0, z), Texture::plain([180, 40, 40]))])
}

/// A table that keeps still: a cuboid on the floor.
fn table(_: u32) -> Subject {
    placed(Solid::cuboid(Vector3::new(0.5, 0.5, TABLE_TOP)).unwrap(), 0.0, 0.5 * TABLE_TOP)
}

/// The table, raised by 5 mm per frame.
fn lifted(frame: u32) -> Subject {
    let half = 0.5 * TABLE_TOP;
    placed(Solid::cuboid(Vector3::new(0.5, 0.5, TABLE_TOP)).unwrap(), 0.0, half + 0.005 * f64::from(frame))
}

/// A ball that moves along x, at 1.2 m/s with 30 frames per second.
fn rolling(frame: u32) -> Subject {
    placed(Solid::sphere(0.25).unwrap(), -0.6 + 0.04 * f64::from(frame), 0.35)
}

/// A board on the floor that moves along x by 40 mm a frame: 1.2 m/s at 30 frames a second.
fn sliding(frame: u32) -> Subject {
    let board = Solid::cuboid(Vector3::new(0.1, 0.6, 0.5)).unwrap();
    placed(board, -0.6 + 0.04 * f64::from(frame), 0.25)
}

/// Path of a folder for a test, which does not exist.
fn folder(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("run").join(name);
    let _ = std::fs::remove_dir_all(&dir);
    dir
}

/// A recording of the subject's exact masks, without images.
fn record(name: &str, subject: fn(u32) -> Subject, frames: u32) -> PathBuf {
    let dir = folder(name);
    let rig = rig();
    let mut recording = Recording::create(&dir, &rig).unwrap();
    for frame in 0..frames {
        let masks: Vec<GrayImage> = rig.cameras().iter().map(|c| silhouette(c, &subject(frame))).collect();
        recording.write_masks(frame, &masks).unwrap();
    }
    dir
}

/// Runs `vhull run`, with results in the recording's folder `out`.
fn run(recording: &Path, arguments: &[&str]) -> Output {
    let out = recording.join("out");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vhull"));
    command.arg("run").arg(recording).arg("--out").arg(out).args(arguments).output().unwrap()
}

/// Exit code and standard error of a run.
fn failure(recording: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = run(recording, arguments);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// Standard output of a run that must succeed.
fn success(recording: &Path, arguments: &[&str]) -> String {
    let output = run(recording, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The rows of states.csv, one for each frame and body: time, body, x, y, z, ...
fn states(recording: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(recording.join("out/states.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next().unwrap(), "time_s,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz");
    lines.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect()
}

/// The bodies and states of the last run.
fn finished(recording: &Path) -> FinishedRun {
    let out = recording.join("out");
    FinishedRun::read(out.join(States::NAME), out.join(BodiesFile::NAME)).unwrap()
}

#[test]
fn a_box_falls_on_the_subject_and_stays() {
    let recording = record("table", table, 3);
    let text = success(&recording, &["--count", "1", "--wait", "1.5", "--linger", "0"]);
    assert!(text.contains("fall on the subject") && text.contains("box 1"), "{text}");

    let states = states(&recording);
    assert_eq!(states.len(), 48, "45 frames in 1.5 s and 3 recorded ones, one body");
    let height = states.last().unwrap()[4];
    // A pixel covers 9 mm here.
    assert!((height - TABLE_TOP - 0.05).abs() < 0.015, "{height}");

    let film = std::fs::read(recording.join("out/run.gif")).unwrap();
    assert_eq!(&film[..6], b"GIF89a");
    assert!(recording.join("out/run.png").is_file() && recording.join("out/heights.svg").is_file());
}

#[test]
fn a_mix_alternates_boxes_and_balls_and_no_gif_writes_no_film() {
    let recording = record("mix", table, 1);
    let arguments =
        ["--drop", "mix", "--count", "3", "--wait", "0.2", "--linger", "0", "--rate", "15", "--no-gif"];
    let text = success(&recording, &arguments);
    assert!(["box 1", "ball 2", "box 3"].iter().all(|name| text.contains(name)), "{text}");
    assert_eq!(states(&recording).len(), 3 * 7);
    assert!(!recording.join("out/run.gif").exists());
}

#[test]
fn the_bodies_of_a_run_are_described_with_where_they_were_and_how_the_recording_was_played() {
    let recording = record("described", table, 3);
    let arguments = ["--drop", "mix", "--count", "2", "--wait", "0.2", "--linger", "0.5", "--no-gif"];
    let text = success(&recording, &[&arguments[..], &["--motion", "held", "--frames", "1.."]].concat());
    assert!(text.contains("bodies.toml"), "{text}");

    let run = finished(&recording);
    let drawn = run.drawn(0);
    assert_eq!(drawn[0].shape, Shape::cube(0.1));
    assert_eq!(drawn[1].shape, Shape::Sphere { radius: 0.05 });
    assert_ne!(drawn[0].colour, drawn[1].colour);
    let rows = states(&recording);
    assert_eq!(run.times().len() * 2, rows.len());
    for k in 0..run.times().len() {
        for (one, row) in run.drawn(k).iter().zip(&rows[2 * k..]) {
            assert_eq!(one.world_from_body.translation.vector.as_slice(), &row[2..5]);
        }
    }

    // What was left to the recording, its rate and work volume, is filled in.
    let played = run.playback().unwrap();
    let bounds = Some(Recording::open(&recording).unwrap().rig().work_volume().unwrap());
    let volume = VolumeOptions { bounds, unseen: UnseenPolicy::Outside };
    let expected = PlaybackOptions { frames: Some(1..3), rate: Some(30.0), wait: 0.2, linger: 0.5, volume };
    assert_eq!((&played.options, played.motion), (&expected, Motion::Held));

    let arguments = ["--rate", "60", "--bounds", "-0.5,0.5,-0.5,0.5,0,1", "--unseen", "abstain"];
    success(&recording, &[&["--count", "1", "--wait", "0", "--no-gif"], &arguments[..]].concat());
    let played = finished(&recording).playback().unwrap().clone();
    let bounds = played.options.volume.bounds.unwrap();
    assert_eq!((bounds.min, bounds.max), (Point3::new(-0.5, -0.5, 0.0), Point3::new(0.5, 0.5, 1.0)));
    assert_eq!(played.options.volume.unseen, UnseenPolicy::Abstain);
    assert_eq!((played.options.rate, played.motion), (Some(60.0), Motion::Interpolated));
}

#[test]
fn a_moving_subject_knocks_a_stack_over_and_equal_seeds_give_equal_states() {
    let recording = record("rolling", rolling, 30);
    let arguments = ["--stack", "3", "--wait", "0.5", "--no-gif", "--bounds", "-1.2,1.4,-1,1,0,1.5"];
    let text = success(&recording, &arguments);
    assert!(text.contains("in the subject's way"), "{text}");

    // Row 14 is the last frame of the hold, 0.5 s at 30 frames per second.
    let first = states(&recording);
    let third: Vec<_> = first.iter().filter(|row| row[1] == 3.0).collect();
    assert!((third[14][4] - 0.5).abs() < 0.01, "the third of three boxes of 20 cm stands: {:?}", third[14]);
    let (before, after) = (third[14], third[third.len() - 1]);
    let moved = (after[2] - before[2]).hypot(after[3] - before[3]);
    assert!(moved > 0.2 && after[4] < 0.45, "it falls off: {after:?}");

    success(&recording, &arguments);
    assert_eq!(first, states(&recording));
}

#[test]
fn the_summary_names_the_hull_that_collides_and_compares_speeds_in_each_motion() {
    let recording = record("motions", rolling, 30);
    let arguments = ["--stack", "3", "--wait", "0.5", "--no-gif", "--bounds", "-1.2,1.4,-1,1,0,1.5"];
    let text = success(&recording, &arguments);
    assert!(
        text.contains("hull: interpolated between frames, one frame late (33 ms)"),
        "the default: {text}"
    );

    for (motion, carried) in
        [("held", "contacts carry no speed"), ("predicted", "contacts carry the surface's speed")]
    {
        let text = success(&recording, &[&arguments[..], &["--motion", motion]].concat());
        let line = text.lines().find(|line| line.starts_with("hull: ")).unwrap();
        assert!(line.contains(motion) && line.contains(carried), "{line}");
        // A pixel covers 9 mm here, and noise of a quarter of it over a tenth of a second is 0.02 m/s; the fit damps.
        let (subject, body) = speeds(&text);
        assert!((subject - 1.2).abs() < 0.12, "the ball rolls at 1.2 m/s: {subject}");
        assert!(body > 0.3, "{body}");
    }
}

/// The subject's speed and the fastest body's in the summary, in m/s.
fn speeds(text: &str) -> (f64, f64) {
    let line = text.lines().find(|line| line.starts_with("speed: ")).unwrap();
    let mut numbers = line.split_whitespace().filter_map(|word| word.parse().ok());
    (numbers.next().unwrap(), numbers.next().unwrap())
}

#[test]
fn a_hull_in_motion_pushes_a_box_as_fast_as_the_subject_moves() {
    let recording = record("push", sliding, 30);
    let arguments =
        ["--stack", "1", "--at", "-0.2,0", "--wait", "0.5", "--no-gif", "--bounds", "-1.2,1.4,-1,1,0,1.5"];
    for motion in ["interpolated", "predicted"] {
        success(&recording, &[&arguments[..], &["--motion", motion]].concat());
        let states = std::fs::read_to_string(recording.join("out/states.csv")).unwrap();
        let numbers = |line: &str| -> Vec<f64> { line.split(',').map(|x| x.parse().unwrap()).collect() };
        let states: Vec<Vec<f64>> = states.lines().skip(1).map(numbers).collect();

        // From a tenth of a second after the touch until the board stops, the box moves with it but for jolts of binary masks
        // with pixels of 9 mm. The figures bound a pushed box's speed by 1.06 of the surface's.
        let at = |time: f64| states.iter().find(|state| state[0] > time).unwrap();
        let (from, to) = (at(0.72), at(1.3));
        let speed = (to[2] - from[2]) / (to[0] - from[0]);
        assert!((0.9..1.06).contains(&(speed / 1.2)), "{motion}: {speed}");
    }
}

#[test]
fn the_summary_says_that_a_subject_stands_still() {
    let recording = record("motionless", table, 6);
    let text = success(&recording, &["--count", "1", "--wait", "0.2", "--no-gif"]);
    assert!(text.contains("speed: the subject does not move"), "{text}");
}

#[test]
fn the_film_shows_the_image_that_is_nearest_to_the_time_of_the_hull() {
    let recording = record("image_times", table, 5);
    let mut images = Recording::open(&recording).unwrap();
    let size = rig().cameras()[0].size();
    for frame in 0..5_u8 {
        let image = RgbImage::from_pixel(size.0, size.1, Rgb([40 * frame; 3]));
        images.write_images(frame.into(), &vec![image; rig().len()]).unwrap();
    }

    // The last still is film frame 24. Its last step begins at (24 * 8 + 7) / 240 = 0.829 s, when frame 3 has been
    // current since 0.8 s. The interpolated hull is 0.1 s older, and nearest to frame 2 of 0.7 s.
    let arguments = ["--count", "1", "--rate", "10", "--wait", "0.5", "--linger", "0.1", "--motion"];
    for (motion, frame) in [("held", 3), ("interpolated", 2)] {
        success(&recording, &[&arguments[..], &[motion]].concat());
        let stills = image::open(recording.join("out/run.png")).unwrap().into_rgb8();
        let [red, ..] = stills.get_pixel(stills.width() - 4, 3).0;
        assert!(red.abs_diff(40 * frame) < 4, "{motion}: {red}");

        // What the run has left behind leads to the same image again.
        let run = finished(&recording);
        let played = run.playback().unwrap();
        let data = HullData::new();
        let opened = Recording::open(&recording).unwrap();
        let mut playback = Playback::new(opened, &recording, &played.options, &data).unwrap();
        let steps = (run.collided_at(24) * STEPS_PER_SECOND).round() as u32;
        (0..=steps).for_each(|k| playback.publish(f64::from(k) / STEPS_PER_SECOND, &data).unwrap());
        let hull = data.in_motion(played.motion, run.collided_at(24)).unwrap();
        let image = playback.picture(0, hull.time()).unwrap();
        assert_eq!(image.get_pixel(3, 3).0, [40 * frame; 3], "{motion}");
    }
}

#[test]
fn a_stack_stands_at_the_given_place_on_the_subject_or_the_floor() {
    let recording = record("at", table, 2);
    for (place, foot) in [("0.05,-0.05", TABLE_TOP), ("0.6,0.3", 0.0)] {
        let arguments =
            ["--stack", "2", "--side", "0.1", "--wait", "0.5", "--linger", "0", "--no-gif", "--at", place];
        success(&recording, &arguments);
        let last = states(&recording).pop().unwrap();
        assert!((last[4] - foot - 0.15).abs() < 0.02, "the second box, at {place}: {last:?}");
    }
}

#[test]
fn a_stack_stands_on_a_subject_that_keeps_still() {
    let recording = record("still", table, 4);
    let arguments = ["--stack", "2", "--side", "0.15", "--wait", "0.5", "--linger", "0", "--no-gif"];
    let text = success(&recording, &arguments);
    assert!(text.contains("on the subject"), "{text}");
    assert!((states(&recording).pop().unwrap()[4] - TABLE_TOP - 0.225).abs() < 0.02);
}

/// Writes a video of one colour for each camera.
fn film(recording: &Path, colour: &str, rate: u32, frames: u32) {
    let source = format!("color={colour}:s=200x160:r={rate}");
    for camera in rig().cameras() {
        let mut ffmpeg = Command::new("ffmpeg");
        ffmpeg.args(["-nostdin", "-loglevel", "error", "-f", "lavfi", "-i", &source, "-c:v", "ffv1"]);
        ffmpeg.args(["-frames:v", &frames.to_string()]).arg(recording.join(camera.name()).join("video.mkv"));
        assert!(ffmpeg.status().expect("ffmpeg, which scripts/setup installs").success());
    }
}

#[test]
fn bodies_are_drawn_into_the_videos_of_the_recording() {
    let recording = record("videos", table, 3);
    film(&recording, "blue", 30, 3);
    success(&recording, &["--count", "1", "--wait", "0.2", "--frames", "1.."]);
    let stills = image::open(recording.join("out/run.png")).unwrap().into_rgb8();
    let [red, _, blue] = stills.get_pixel(3, 3).0;
    assert!(red < 30 && blue > 200, "{:?}", stills.get_pixel(3, 3));

    // A file that is no video.
    for camera in rig().cameras() {
        std::fs::write(recording.join(camera.name()).join("video.mkv"), b"no video").unwrap();
    }
    let (code, text) = failure(&recording, &["--count", "1", "--wait", "0"]);
    assert!(code == Some(1) && text.contains("video.mkv: expected a video"), "{text}");

    // A video that ends before the frames that are played.
    for camera in rig().cameras() {
        std::fs::remove_file(recording.join(camera.name()).join("video.mkv")).unwrap();
    }
    film(&recording, "blue", 30, 1);
    let (code, text) = failure(&recording, &["--count", "1", "--wait", "0", "--frames", "1.."]);
    assert!(code == Some(1) && text.contains("expected an image as frame 1"), "{text}");
    assert!(text.contains("--no-gif"), "{text}");
    success(&recording, &["--count", "1", "--wait", "0", "--frames", "1..", "--no-gif"]);
}

#[test]
fn the_subject_moves_by_the_times_of_the_recording_whatever_the_frame_rate_of_the_film() {
    let recording = record("pace", lifted, 30);
    let play = |options: &[&str]| {
        let arguments = [&["--count", "1", "--wait", "1", "--linger", "0", "--no-gif"], options].concat();
        let output = run(&recording, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let heights: Vec<f64> = states(&recording).iter().map(|row| row[4]).collect();
        // A pixel covers 9 mm here.
        let lift = heights[heights.len() - 1] - heights[29];
        assert!((lift - 0.145).abs() < 0.02, "{lift}");
        (heights, String::from_utf8(output.stderr).unwrap())
    };

    // Without times 30 images per second are assumed, with a note; --rate sets others.
    let (heights, note) = play(&[]);
    assert_eq!(heights.len(), 60, "1 s of hold and 30 recorded frames in 1 s");
    assert!(note.contains("--rate"), "{note}");
    let (at_60, note) = play(&["--rate", "60"]);
    assert_eq!((at_60.len(), note.as_str()), (45, ""), "1 s of hold and 30 recorded frames in 0.5 s");

    // Times in frames.csv.
    let lines = (0..30).map(|frame| format!("{frame},{:.6}\n", 3.0 + f64::from(frame) / 60.0));
    std::fs::write(recording.join("frames.csv"), format!("frame,time\n{}", lines.collect::<String>()))
        .unwrap();
    // Times in the file are rounded to a microsecond, which moves an interpolated hull by less than a micrometre; contacts
    // may amplify that.
    let is_close =
        |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
    assert!(is_close(&play(&[]).0, &at_60));
    assert_eq!(play(&["--rate", "30"]).0, heights, "--rate takes precedence over frames.csv");

    // The frame rate of videos.
    std::fs::remove_file(recording.join("frames.csv")).unwrap();
    film(&recording, "blue", 60, 2);
    assert!(is_close(&play(&[]).0, &at_60));
}

#[test]
fn only_the_given_frames_are_played() {
    let recording = record("frames", table, 6);
    success(&recording, &["--count", "1", "--frames", "2..5", "--wait", "0", "--linger", "0.1", "--no-gif"]);
    assert_eq!(states(&recording).len(), 6);
    let (code, text) = failure(&recording, &["--frames", "9.."]);
    assert_eq!(code, Some(1));
    assert!(text.contains("from 0 to 5") && text.contains("none in 9..\n"), "{text}");
}

#[test]
fn the_error_for_a_recording_without_masks_names_vhull_segment() {
    let dir = folder("images");
    let rig = rig();
    let mut recording = Recording::create(&dir, &rig).unwrap();
    let images = vec![RgbImage::new(200, 160); rig.len()];
    recording.write_images(0, &images).unwrap();
    let (code, text) = failure(&dir, &[]);
    assert_eq!(code, Some(1));
    assert!(text.contains("expected masks") && text.contains("vhull segment"), "{text}");
}

#[test]
fn errors_name_a_missing_camera_folder_an_unknown_view_and_an_empty_hull() {
    let recording = record("wrong", table, 1);
    let camera = rig().cameras()[2].name().to_owned();
    let (code, text) = failure(&recording, &["--view", "unknown"]);
    assert_eq!(code, Some(1));
    assert!(text.contains("--view: expected 0 to 5") && text.contains(&camera), "{text}");

    let (code, text) = failure(&recording, &["--bounds", "0.35,0.5,0.35,0.5,0,0.3"]);
    assert_eq!(code, Some(1));
    assert!(text.contains("empty hull") && text.contains("--bounds"), "{text}");

    std::fs::remove_dir_all(recording.join(&camera)).unwrap();
    let (code, text) = failure(&recording, &[]);
    assert_eq!(code, Some(1));
    assert!(text.contains(&camera) && text.contains("expected the folder"), "{text}");

    let (code, text) = failure(&recording.join("nowhere"), &[]);
    assert_eq!(code, Some(1));
    assert!(text.contains("expected the folder of a recording"), "{text}");
}

#[test]
fn an_invalid_command_line_exits_with_code_2_and_names_what_was_expected() {
    let recording = folder("unused");
    for (arguments, part) in [
        (&["--bounds", "1,2,3"][..], "x0,x1,y0,y1,z0,z1"),
        (&["--bounds", "1,0,0,1,0,1"], "--bounds"),
        (&["--side", "7"], "0.05 to 2 m"),
        (&["--wait=-1"], "0 to 3600 s"),
        (&["--wait", "NaN"], "0 to 3600 s"),
        (&["--linger", "x"], "0 to 3600 s"),
        (&["--rate", "0"], "images per second"),
        (&["--frames", "5..5"], "A below B"),
        (&["--frames", "x..y"], "20..60"),
        (&["--stack", "2", "--at", "1"], "x,y"),
        (&["--at", "1,2"], "--stack"),
        (&["--drop", "boxes", "--stack", "3"], "cannot be used with"),
        (&["--drop", "cats"], "spheres"),
        (&["--count", "0"], "--count"),
        (&["--unseen", "maybe"], "abstain"),
        (&["--motion", "frozen"], "held, interpolated, predicted"),
    ] {
        let (code, text) = failure(&recording, arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {text}");
        assert!(text.contains(part), "{arguments:?}: {text}");
    }
}

#[test]
fn states_before_a_broken_mask_are_kept() {
    let recording = record("broken", table, 40);
    // 24 of the 40 frames are read beforehand to find the subject's extent; frame 21 is not one of them.
    let broken = recording.join(rig().cameras()[1].name()).join("mask/000021.png");
    std::fs::write(&broken, b"no image").unwrap();
    let (code, text) = failure(&recording, &["--count", "1", "--wait", "0", "--no-gif"]);
    assert_eq!(code, Some(1));
    assert!(text.contains("000021.png") && text.contains("the 21 frames before"), "{text}");
    assert_eq!(states(&recording).len(), 21);
}

#[test]
fn the_error_for_a_folder_that_cannot_be_created_says_so() {
    let recording = record("unwritable", table, 1);
    std::fs::write(recording.join("out"), b"a file").unwrap();
    let (code, text) = failure(&recording, &["--count", "1", "--wait", "0", "--no-gif"]);
    assert_eq!(code, Some(1));
    assert!(text.contains("expected to make this folder"), "{text}");
}

#[test]
fn a_box_that_sticks_to_a_board_stops_with_it_and_does_not_slide_on() {
    let recording = record("sticky", sliding, 30);
    let end_of = |hold: &[&str]| {
        let arguments = ["--stack", "1", "--at", "0,0", "--wait", "0.2", "--no-gif"];
        let bounds = ["--bounds", "-1.2,1.4,-1,1,0,1.5"];
        success(&recording, &[&arguments[..], &bounds, hold].concat());
        states(&recording).last().unwrap()[2]
    };
    let (pushed, stuck) = (end_of(&[]), end_of(&["--hold", "0.."]));
    // At 1.2 m/s it slides on by 9 cm with a coefficient of friction of 0.8; the hull's edges are known to a pixel of 9 mm.
    assert!(pushed - stuck > 0.05, "{pushed} m, {stuck} m");
}

#[test]
fn times_to_stick_that_make_no_sense_are_refused() {
    let recording = record("stick", table, 1);
    let (code, error) = failure(&recording, &["--hold", "3..2"]);
    assert!(code == Some(2) && error.contains("expected seconds A..B with A below B"), "{error}");
    let (code, error) = failure(&recording, &["--wait", "1", "--linger", "0", "--hold", "7..8"]);
    assert!(code != Some(0) && error.contains("begin before the end of the film"), "{error}");
}
