//! The window of `vhull-view live`, on a display without a screen (Xvfb): keys and mouse come from outside, and what is shown
//! is photographed from outside.

mod display;
mod ends;

use display::{Display, Session};
use image::RgbImage;

/// The number of pixels in which two photographs of one size differ.
fn differing(a: &RgbImage, b: &RgbImage) -> usize {
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

/// A session in which time stands still, so that pictures change by what is done alone.
fn frozen(display: &Display) -> Session<'_> {
    let mut session = display.live(&["--synthetic", "3", "--image-size", "160x120"]);
    session.key("space");
    session.wait_until_still();
    session
}

#[test]
fn each_toggle_changes_the_picture_and_changes_it_back() {
    let display = Display::start();
    let mut session = frozen(&display);
    session.key("i");
    // All cameras are in sight from farther away.
    session.wheel_back(8);
    session.wait_until_still();
    let before = session.photo();
    for (key, name) in [
        ("k", "cameras"),
        ("x", "axes"),
        ("v", "work volume"),
        ("p", "samples"),
        ("question", "keys"),
        ("h", "shape"),
        ("f", "refinement"),
    ] {
        session.key(key);
        assert!(session.changes_from(&before), "{name}");
        session.key(key);
        assert!(session.returns_to(&before), "{name}");
    }
    session.key("Escape");
    let end = session.end();
    assert!(end.succeeded && end.out.contains("pictures"), "{}{}", end.out, end.error);
}

#[test]
fn the_viewpoint_turns_by_a_drag_goes_to_a_real_camera_and_returns() {
    let display = Display::start();
    let mut session = frozen(&display);
    session.key("i");
    session.wait_until_still();
    let home = session.photo();
    session.drag((160, 120), (230, 140));
    assert!(session.changes_from(&home), "by a drag");
    session.wait_until_still();
    let turned = session.photo();
    session.key("2");
    assert!(session.changes_from(&turned), "to a camera");
    session.key("0");
    assert!(session.returns_to(&home), "home");
}

#[test]
fn time_stands_still_goes_on_by_a_frame_and_goes_on() {
    let display = Display::start();
    let mut session = frozen(&display);
    session.key("i");
    session.wait_until_still();
    let before = session.photo();
    (0..6).for_each(|_| session.key("period"));
    assert!(session.changes_from(&before), "by frames");
    session.wait_until_still();
    let after = session.photo();
    session.key("space");
    assert!(session.changes_from(&after), "by the clock");
}

#[test]
fn a_click_throws_a_ball() {
    let display = Display::start();
    let mut session = frozen(&display);
    session.key("i");
    session.wait_until_still();
    let is_ball = |pixel: &&image::Rgb<u8>| {
        let [r, g, b] = pixel.0.map(i32::from);
        r > 150 && (r - g) > 70 && (g - b) > 20 && g > 60
    };
    let count = |photo: &RgbImage| photo.pixels().filter(is_ball).count();
    let before = count(&session.photo());
    session.click((160, 100));
    // The ball starts with the next step, and is in front of the eye for some frames.
    (0..3).for_each(|_| session.key("period"));
    session.wait_until_still();
    let after = count(&session.photo());
    assert!(after > before + 20, "{before} pixels of its colour, then {after}");
}

#[test]
fn a_window_may_have_any_size() {
    let display = Display::start();
    let mut session = frozen(&display);
    for size in [(1, 1), (500, 90), (90, 400), (320, 240)] {
        session.resize(size);
        session.wait_until_still();
    }
    let photo = session.photo();
    assert_eq!(photo.dimensions(), (320, 240));
    let colours: std::collections::HashSet<_> = photo.pixels().map(|pixel| pixel.0).collect();
    assert!(colours.len() > 100, "{} colours", colours.len());
    assert!(session.is_running());
}
