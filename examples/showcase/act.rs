//! A scene of the showcase: a subject that moves, cameras around it, virtual bodies, and a claim about them.

use crate::shared::{self, FilmArguments, Filmed};
use clap::{CommandFactory, FromArgMatches, Parser};
use nalgebra::{Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, Motion};
use ode_visual_hull::ode::Swept;
use ode_visual_hull::synthetic::{Subject, layout};
use ode_visual_hull_film::{FilmReport, Log, Scenario, Simulation};
use std::process::ExitCode;

/// The name of the film, which is that of the example, and the folder for it unless another is given.
const NAME: &str = env!("CARGO_CRATE_NAME");
const OUT: &str = concat!("target/", env!("CARGO_CRATE_NAME"));

const IMAGE: (u32, u32) = (640, 480);

/// The horizontal angle of view of all cameras, in radians.
const FIELD: f64 = 0.85;

/// Number of the cameras around the subject, and how far they look down on it in turn, in radians.
const AROUND: usize = 8;
const DOWNWARDS: [f64; 4] = [0.05, 0.45, 0.2, 0.6];

/// A scene.
pub struct Act {
    /// What happens, for `--help`.
    pub about: &'static str,
    /// A word for the subject.
    pub who: &'static str,
    /// The subject at a time, in seconds.
    pub subject: fn(f64) -> Result<Subject>,
    /// Until when the subject stands still and when the film ends, in seconds.
    pub still_until: f64,
    pub end: f64,
    /// Where the subject meets the bodies, and how far from there the hull reaches, in metres.
    pub place: Point3<f64>,
    pub reach: f64,
    /// From where the film is taken, and where its camera looks.
    pub eye: Point3<f64>,
    pub target: Point3<f64>,
}

/// What a scene claims, in words with the figures that were measured.
pub struct Claim {
    pub holds: bool,
    pub text: String,
}

#[derive(Debug, Parser)]
#[command(version)]
struct Options {
    #[command(flatten)]
    film: FilmArguments,
}

impl Act {
    /// Films the bodies that `add_bodies` adds, and fails where the claim does not hold in the end. A film that was cut short
    /// claims nothing.
    pub fn play(
        self,
        add_bodies: impl FnOnce(&mut Simulation) -> Result<()>,
        claim: impl FnOnce(&Log) -> Claim,
    ) -> ExitCode {
        let matches = Options::command().name(NAME).about(self.about).get_matches();
        let options = Options::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
        let is_whole = options.film.frames.is_none();
        let report = match self.film(&options.film, add_bodies) {
            Ok(report) => report,
            Err(error) => return shared::tell(Err(error)),
        };
        if !is_whole {
            return shared::tell(Ok(report.text));
        }

        let Claim { holds, text } = claim(&report.log);
        let told = shared::tell(Ok(format!(
            "{}\nclaim: {text}{}\n",
            report.text,
            if holds { "" } else { ": FAILED" }
        )));
        if holds { told } else { ExitCode::FAILURE }
    }

    fn film(
        self,
        arguments: &FilmArguments,
        add_bodies: impl FnOnce(&mut Simulation) -> Result<()>,
    ) -> Result<FilmReport> {
        let filmed = Filmed {
            cameras: self.cameras()?,
            bounds: Aabb::new(
                self.place - Vector3::repeat(self.reach),
                self.place + Vector3::repeat(self.reach),
            )?,
            place: self.place,
            motion: Motion::Interpolated,
            name: NAME,
            out: OUT,
            scenario: self,
        };
        shared::film(filmed, arguments, |simulation| {
            simulation.set_swept(Swept::On);
            add_bodies(simulation)
        })
    }

    /// Cameras around the place that see all within reach of it; the last one shows the scene.
    fn cameras(&self) -> Result<Vec<Camera>> {
        let distance = 1.1 * self.reach / (0.5 * FIELD).tan() * IMAGE.0 as f64 / IMAGE.1 as f64;
        let heights = DOWNWARDS.map(|angle: f64| self.place.z + distance * angle.tan());
        let mut cameras = layout::staggered(AROUND, distance, &heights, self.place, IMAGE, FIELD)?;
        cameras.push(Camera::look_at("film", IMAGE, FIELD, self.eye, self.target, Vector3::z())?);
        Ok(cameras)
    }
}

impl Scenario for Act {
    fn name(&self) -> &str {
        self.who
    }

    fn subject(&self, time: f64) -> Result<Subject> {
        (self.subject)(time)
    }

    fn top(&self, _: f64) -> Option<f64> {
        None
    }

    fn still_until(&self) -> f64 {
        self.still_until
    }

    fn end(&self) -> f64 {
        self.end
    }

    fn moments(&self) -> [f64; 3] {
        [self.still_until, 0.5 * (self.still_until + self.end), self.end]
    }
}
