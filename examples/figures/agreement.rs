//! Agreement of the hull's responses with the reference, with distorting lenses, with abstaining views, and with both.
//!
//! ```text
//!   +---------+   +---------+   +---------+
//!   |         |   #         |   |         |     every second camera is turned aside, so that
//!   |   ###   |   ##        |   |         |     its image's border cuts the subject off
//!   |         |   #         |   +---###---+
//!   +---------+   +---------+
//! ```

use nalgebra::{Isometry3, Point2, Point3, UnitQuaternion, point};
use ode_visual_hull::camera::{Camera, Distortion, Fisheye, Lens};
use ode_visual_hull::hull::{Aabb, Hull, HullData, PointResponse, Response, Unseen, Workspace, reference};
use ode_visual_hull::synthetic::{self, Subject, layout};
use ode_visual_hull_testing::figure::{Bound, Figure};
use ode_visual_hull_testing::quality::accuracy::{mean, share};
use ode_visual_hull_testing::quality::scene;
use ode_visual_hull_testing::random::Random;
use std::sync::Arc;

/// Image size in pixels, small because the reference visits every pixel.
const SIZE: (u32, u32) = (320, 240);
const FIELD_OF_VIEW: f64 = 0.9;
const TARGET: Point3<f64> = Point3::new(0.0, 0.0, 0.5);
const HEIGHTS: [f64; 7] = [0.15, 1.1, 0.45, 1.5, 0.0, 1.2, 0.8];

/// The target's position in the images of the cameras, in cyclic order: in the middle, and near a border.
const TARGET_PX: [Point2<f64>; 4] = [
    Point2::new(160.0, 120.0),
    Point2::new(12.0, 130.0),
    Point2::new(160.0, 120.0),
    Point2::new(170.0, 228.0),
];

/// Number of points inside in each scene.
const POINTS: usize = 2000;

/// Largest difference of depths in metres, and of unit normals: both implementations compute the same pixel border in
/// closed form.
const TOLERANCE: f64 = 1e-9;

/// The kind of cameras of a figure.
#[derive(Debug, Clone, Copy)]
struct Kind {
    name: &'static str,
    optics: Optics,
    unseen: Unseen,
}

/// The cameras' lenses.
#[derive(Debug, Clone, Copy)]
enum Optics {
    Pinhole,
    /// OpenCV's polynomial, k1 = -0.36.
    Barrel,
    /// OpenCV's fisheye.
    Fisheye,
}

const KINDS: [Kind; 5] = [
    Kind { name: "reference_agree_lens", optics: Optics::Barrel, unseen: Unseen::Outside },
    Kind { name: "reference_agree_abstain", optics: Optics::Pinhole, unseen: Unseen::ABSTAIN },
    Kind { name: "reference_agree_lens_abstain", optics: Optics::Barrel, unseen: Unseen::ABSTAIN },
    Kind { name: "reference_agree_fisheye", optics: Optics::Fisheye, unseen: Unseen::Outside },
    Kind { name: "reference_agree_fisheye_abstain", optics: Optics::Fisheye, unseen: Unseen::ABSTAIN },
];

impl Optics {
    fn lens(self) -> Lens {
        match self {
            Self::Pinhole => Lens::none(),
            Self::Barrel => {
                Distortion::from_opencv(&[-0.36, 0.0, 0.0, 0.0]).expect("four coefficients").into()
            }
            Self::Fisheye => {
                Fisheye::from_opencv(&[0.05, -0.01, 2e-3, -2e-4]).expect("four coefficients").into()
            }
        }
    }

    /// The focal length as a share of that of a pinhole that sees [`FIELD_OF_VIEW`]: a fisheye sees more.
    fn focal_share(self) -> f64 {
        match self {
            Self::Pinhole | Self::Barrel => 1.0,
            Self::Fisheye => 0.6,
        }
    }
}

/// The results in one scene.
struct Measured {
    scene: String,
    agreement: f64,
    /// The share of the points inside that some view does not see.
    unseen: f64,
}

/// Figures of each kind of cameras: the agreement in the worst scene, with its bound, and in each scene; and where
/// views abstain, the mean share of points inside that some view does not see.
pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let mut figures = Vec::new();
    for kind in KINDS {
        let scenes = scene::SHAPES.into_iter().flat_map(|shape| [5, 7].map(|n| (shape, n)));
        let measured: Vec<Measured> = scenes
            .map(|(shape, n)| {
                progress(&format!("{}, {shape}_{n}", kind.name));
                measure_scene(kind, shape, n)
            })
            .collect();

        let worst = measured.iter().map(|measured| measured.agreement).fold(1.0, f64::min);
        figures.push(Figure::bounded(kind.name, worst, Bound::AtLeast(1.0)));

        for Measured { scene, agreement, .. } in &measured {
            figures.push(Figure::reported(&format!("{}_{scene}", kind.name), *agreement));
        }
        if kind.unseen != Unseen::Outside {
            let unseen: Vec<f64> = measured.iter().map(|measured| measured.unseen).collect();
            figures.push(Figure::reported(&format!("{}_unseen_share", kind.name), mean(&unseen)));
        }
    }

    figures
}

fn measure_scene(kind: Kind, shape: &str, n: usize) -> Measured {
    let hull = hull(kind, shape, n);
    let points = points(&hull, 5);
    let mut workspace = Workspace::new();
    let mut many = hull.respond_many(&points, &mut workspace).iter().peekable();

    let agreement = share(points.iter().enumerate().map(|(index, p)| {
        let many = many.next_if(|response| response.point == index);
        hull.inside(p) == reference::inside(&hull, p) && agree(&hull, p, many, hull.respond(p))
    }));

    let is_unseen = |p: &Point3<f64>| hull.views().iter().any(|view| view.pixel(p).is_none());
    let unseen = share(points.iter().filter(|p| hull.inside(p)).map(is_unseen));
    Measured { scene: format!("{shape}_{n}"), agreement, unseen }
}

/// Whether the results of the batch and of the single query equal the reference's: response or none, deciding view,
/// pixel b, normal and depth.
fn agree(hull: &Hull, p: &Point3<f64>, many: Option<&PointResponse>, single: Option<Response>) -> bool {
    match (many, single, reference::respond(hull, p)) {
        (None, None, None) => true,
        (Some(many), Some(single), Some(expected)) => {
            let view = &hull.views()[expected.view];
            let results = [(many.normal, many.depth), (single.normal, single.depth)];
            many.view == expected.view
                && std::ptr::eq(single.nearest.view, view)
                && single.nearest.b == expected.b
                && results.iter().all(|(normal, depth)| {
                    (normal - expected.normal).norm() <= TOLERANCE
                        && (depth - expected.depth).abs() <= TOLERANCE
                })
        }
        _ => false,
    }
}

/// Random points in and around the hull, of which [`POINTS`] are inside by the reference.
fn points(hull: &Hull, seed: u64) -> Vec<Point3<f64>> {
    let mut random = Random(seed);
    let around = hull.aabb().grown(0.02);
    let (mut points, mut inside) = (Vec::new(), 0);
    while inside < POINTS {
        let p = random.point(around.min, around.max);
        inside += usize::from(reference::inside(hull, &p));
        points.push(p);
    }
    points
}

/// The hull of `shape` seen by `n` cameras of `kind`.
fn hull(kind: Kind, shape: &str, n: usize) -> Arc<Hull> {
    let subject = Subject::new(vec![scene::placed(shape)]);
    let cameras = cameras(kind.optics, n);
    let data = HullData::new();

    let update = || {
        data.set_bounds(Aabb::new(point![-0.45, -0.45, 0.05], point![0.45, 0.45, 0.95])?)?;
        data.set_unseen(kind.unseen)?;
        data.add_views(&cameras)?;
        for (view, camera) in cameras.iter().enumerate() {
            data.set_mask(view, &synthetic::silhouette(camera, &subject))?;
        }
        data.update(0.0)
    };
    update().expect("valid cameras and masks")
}

/// Cameras around the target, each turned to see the target at its position of [`TARGET_PX`].
fn cameras(optics: Optics, n: usize) -> Vec<Camera> {
    let around = layout::staggered(n, 1.6, &HEIGHTS, TARGET, SIZE, FIELD_OF_VIEW).expect("a valid layout");

    let with_pose = |camera: &Camera, cam_from_world: Isometry3<f64>| {
        let (name, size, mut k) = (camera.name(), camera.size(), *camera.intrinsics());
        k[(0, 0)] *= optics.focal_share();
        k[(1, 1)] *= optics.focal_share();
        Camera::new(name, size, k, optics.lens(), cam_from_world).expect("a valid camera")
    };

    let turned = |(camera, at): (&Camera, &Point2<f64>)| {
        let ray =
            with_pose(camera, *camera.cam_from_world()).ray(at.x, at.y).expect("a pixel within the lens");
        let turn = UnitQuaternion::rotation_between(&camera.forward(), &ray.direction)
            .expect("less than half a turn");
        with_pose(camera, camera.cam_from_world() * Isometry3::rotation_wrt_point(turn, camera.centre()))
    };
    around.iter().zip(TARGET_PX.iter().cycle()).map(turned).collect()
}
