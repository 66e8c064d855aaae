//! A display without a screen, and `vhull-view live` on it.

use super::differing;
use image::RgbImage;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// How long anything may take on a machine that is busy.
const PATIENCE: Duration = Duration::from_secs(120);

/// The size of the window in pixels.
const SIZE: (u32, u32) = (320, 240);

/// From one look to the next.
const TICK: Duration = Duration::from_millis(150);

/// A running X server.
pub struct Display {
    server: Child,
    name: String,
    // Kept open: the server writes to it.
    _number: BufReader<ChildStdout>,
}

/// A running `vhull-view live`.
pub struct Session<'d> {
    display: &'d Display,
    program: Child,
    window: String,
    size: (u32, u32),
}

/// How a session has ended.
pub struct End {
    pub succeeded: bool,
    pub out: String,
    pub error: String,
}

impl Display {
    /// Starts a server with a number that is free.
    pub fn start() -> Self {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb; install it with scripts/setup xvfb xdotool");
        let mut number = BufReader::new(server.stdout.take().expect("a pipe"));
        let mut line = String::new();
        number.read_line(&mut line).expect("the number of the display");
        Self { server, name: format!(":{}", line.trim()), _number: number }
    }

    /// `vhull-view live` with these arguments on this display.
    pub fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vhull-view"));
        command.arg("live").args(words).args(["--size", "320x240", "--renderer", "cpu"]);
        command
            .env("DISPLAY", &self.name)
            .env_remove("WAYLAND_DISPLAY")
            .current_dir(env!("CARGO_TARGET_TMPDIR"));
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Starts it and waits for its first picture.
    pub fn live(&self, words: &[&str]) -> Session<'_> {
        let program = self.command(words).spawn().expect("vhull-view runs");
        let mut session = Session { display: self, program, window: String::new(), size: SIZE };
        session.window = session.wait_for("a window", |session| {
            let found = session.xdotool(&["search", "--name", "^vhull-view$"]);
            found.lines().next().map(str::to_owned)
        });
        // The window belongs to no window manager that would give it the focus.
        session.xdotool(&["windowfocus", "--sync", &session.window]);
        session.wait_for("a picture", |session| {
            let photo = session.photo();
            photo.pixels().any(|pixel| pixel.0 != [0; 3]).then_some(())
        });
        session
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl Session<'_> {
    /// Presses a key, by its name in X.
    pub fn key(&mut self, name: &str) {
        self.xdotool(&["key", "--clearmodifiers", name]);
    }

    /// Clicks into the window.
    pub fn click(&mut self, at: (i32, i32)) {
        self.mouse_to(at);
        self.xdotool(&["click", "1"]);
    }

    /// Turns the wheel towards the user by so many notches.
    pub fn wheel_back(&mut self, notches: u32) {
        self.mouse_to((20, 20));
        self.xdotool(&["click", "--repeat", &notches.to_string(), "5"]);
    }

    /// Moves the mouse from one place in the window to another with its left button down.
    pub fn drag(&mut self, from: (i32, i32), to: (i32, i32)) {
        self.mouse_to(from);
        self.xdotool(&["mousedown", "1"]);
        self.mouse_to(((from.0 + to.0) / 2, (from.1 + to.1) / 2));
        self.mouse_to(to);
        self.xdotool(&["mouseup", "1"]);
    }

    fn mouse_to(&self, (x, y): (i32, i32)) {
        self.xdotool(&["mousemove", "--sync", "--window", &self.window, &x.to_string(), &y.to_string()]);
    }

    /// Gives the window another size.
    pub fn resize(&mut self, size: (u32, u32)) {
        self.size = size;
        self.xdotool(&["windowsize", "--sync", &self.window, &size.0.to_string(), &size.1.to_string()]);
    }

    /// What the window shows.
    pub fn photo(&self) -> RgbImage {
        let (width, height) = self.size;
        // Xvfb takes no photograph of an odd size through x11grab's scaler; raw pixels have no scaler.
        let output = Command::new("ffmpeg")
            .args(["-v", "error", "-f", "x11grab", "-draw_mouse", "0", "-video_size"])
            .args([&format!("{width}x{height}"), "-i", &self.display.name])
            .args(["-frames:v", "1", "-f", "rawvideo", "-pix_fmt", "rgb24", "pipe:1"])
            .output()
            .expect("ffmpeg runs");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        RgbImage::from_raw(width, height, output.stdout).unwrap_or_else(|| panic!("{error}"))
    }

    /// Whether the picture becomes another one than `before`.
    pub fn changes_from(&self, before: &RgbImage) -> bool {
        self.comes_to_be(|photo| differing(photo, before) > 0)
    }

    /// Whether the picture becomes the one that it was.
    pub fn returns_to(&self, before: &RgbImage) -> bool {
        self.comes_to_be(|photo| differing(photo, before) == 0)
    }

    fn comes_to_be(&self, is_so: impl Fn(&RgbImage) -> bool) -> bool {
        let started = Instant::now();
        while started.elapsed() < PATIENCE {
            if is_so(&self.photo()) {
                return true;
            }
            sleep(TICK);
        }
        false
    }

    /// Waits until the picture does not change any more.
    pub fn wait_until_still(&self) {
        let mut last = self.photo();
        let mut same = 0;
        self.wait_for("a picture that stands still", |session| {
            sleep(2 * TICK);
            let photo = session.photo();
            same = if photo == last { same + 1 } else { 0 };
            last = photo;
            (same == 3).then_some(())
        });
    }

    /// Whether the program runs.
    pub fn is_running(&mut self) -> bool {
        self.program.try_wait().expect("a state").is_none()
    }

    /// The number of its process.
    pub fn process(&self) -> u32 {
        self.program.id()
    }

    /// Waits for the program to end.
    pub fn end(mut self) -> End {
        let started = Instant::now();
        while self.is_running() {
            assert!(started.elapsed() < PATIENCE, "expected the program to end");
            sleep(TICK);
        }
        let text = |pipe: Option<&mut dyn Read>| {
            let mut text = String::new();
            pipe.map(|pipe| pipe.read_to_string(&mut text));
            text
        };
        let succeeded = self.program.wait().expect("a state").success();
        let out = text(self.program.stdout.as_mut().map(|pipe| pipe as &mut dyn Read));
        let error = text(self.program.stderr.as_mut().map(|pipe| pipe as &mut dyn Read));
        End { succeeded, out, error }
    }

    fn wait_for<T>(&self, what: &str, mut found: impl FnMut(&Self) -> Option<T>) -> T {
        let started = Instant::now();
        loop {
            if let Some(found) = found(self) {
                return found;
            }
            assert!(started.elapsed() < PATIENCE, "expected {what}");
            sleep(TICK);
        }
    }

    fn xdotool(&self, words: &[&str]) -> String {
        let output = Command::new("xdotool").args(words).env("DISPLAY", &self.display.name).output();
        let output = output.expect("xdotool; install it with scripts/setup xvfb xdotool");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }
}

impl Drop for Session<'_> {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// An empty folder for a test.
pub fn folder(test: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("window_{test}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).expect("a folder");
    path
}
