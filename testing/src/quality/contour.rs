//! The exact silhouette contour of a solid in one camera, traced by casting rays.
//!
//! ```text
//!   o---o---o---o      o background, # subject: rays through a lattice of half pixels
//!   |   |  /|   |      where two neighbours differ, bisection finds the contour between them;
//!   o---o-/-#---#      the line between the crossings of a cell is a segment of the contour
//!   |   |/  |   |
//! ```

use nalgebra::{Point2, Point3, Vector2, Vector3};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::synthetic::Placed;

/// Distance between rays in pixels. At half a pixel the lattice includes the pixels' centres, so that no subject or
/// background pixel of a binary mask is missed, and chords lie within 0.002 px of a contour of 20 px radius.
const LATTICE: f64 = 0.5;

/// Distance in pixels, to both sides of a contour point, of the two points that determine its tangent.
const TANGENT_STEP: f64 = 0.1;

/// Angle in radians by which a bend turns within [`BEND_REACH`]. So corners are bends, and radii below 14 px.
const BEND_ANGLE: f64 = 8.0 * std::f64::consts::PI / 180.0;

/// Distance in pixels within which a bend turns by [`BEND_ANGLE`].
const BEND_REACH: f64 = 2.0;

/// The silhouette of one solid in one camera.
pub struct Contour {
    camera: Camera,
    centre: Point3<f64>,
    solid: Placed,
    /// Segments of the contour by the pixel row of their middle.
    rows: Vec<Vec<Segment>>,
    bends: Vec<Point2<f64>>,
}

#[derive(Debug, Clone, Copy)]
struct Segment {
    from: Point2<f64>,
    to: Point2<f64>,
    /// Unit normal, from the subject to the background.
    normal: Vector2<f64>,
}

impl Contour {
    /// The contour of `solid`, which `camera` has to see entirely and without lens distortion.
    pub fn trace(camera: &Camera, solid: &Placed) -> Self {
        let (camera, solid) = (camera.clone(), solid.clone());
        let centre = camera.centre();
        let mut contour = Self { camera, centre, solid, rows: Vec::new(), bends: Vec::new() };
        let segments = contour.segments();
        contour.bends = bends(&segments);
        contour.rows = vec![Vec::new(); contour.camera.size().1 as usize];
        segments.into_iter().for_each(|segment| contour.rows[segment.middle().y as usize].push(segment));
        contour
    }

    /// The camera of the contour.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Whether the half-line from the camera through `p` meets the solid.
    pub fn sees(&self, p: &Point3<f64>) -> bool {
        self.solid.is_hit(&Ray { origin: self.centre, direction: (p - self.centre).normalize() })
    }

    /// The contour point nearest to `at`, by bisection within 0.2 px of the nearest chord point; the chord point itself
    /// where the contour is farther away.
    pub fn nearest(&self, at: &Point2<f64>) -> Point2<f64> {
        let (chord, segment) = self.nearest_on_chords(at);
        let towards = (chord - at).try_normalize(1e-3).unwrap_or(segment.normal);
        self.crossing(&chord, &towards, 0.2).unwrap_or(chord)
    }

    /// Distance in pixels from the image of `p`, a point in front of the camera, to the contour; negative inside the
    /// silhouette.
    pub fn signed_distance_of(&self, p: &Point3<f64>) -> f64 {
        let distance = self.project(p).map_or(f64::INFINITY, |at| (self.nearest(&at) - at).norm());
        if self.sees(p) { -distance } else { distance }
    }

    /// The unit normal of the contour at its point `on`, from the subject to the background; `None` where the contour
    /// is not smooth.
    pub fn normal(&self, on: &Point2<f64>) -> Option<Vector2<f64>> {
        let across = self.nearest_on_chords(on).1.normal;
        let along = Vector2::new(-across.y, across.x);
        let beside = |step: f64| self.crossing(&(on + along * step), &across, 0.5);
        let tangent = beside(TANGENT_STEP)? - beside(-TANGENT_STEP)?;
        Some(Vector2::new(tangent.y, -tangent.x).normalize())
    }

    /// The outward normal in the world of the plane through the camera and the contour's tangent at `on`.
    pub fn normal_in_world(&self, on: &Point2<f64>) -> Option<Vector3<f64>> {
        let across = self.normal(on)?;
        let ray = |at: Point2<f64>| self.camera.ray(at.x, at.y).map(|ray| ray.direction);
        let along = Vector2::new(-across.y, across.x);
        let plane = ray(on + along)?.cross(&ray(on - along)?).normalize();
        Some(plane * plane.dot(&ray(on + across)?).signum())
    }

    /// Whether `p` projects to within `reach` pixels of the contour.
    pub fn is_near(&self, p: &Point3<f64>, reach: f64) -> bool {
        self.project(p).is_some_and(|at| self.nearest_within(&at, reach).is_some())
    }

    /// Whether the contour bends within `reach` pixels of `at`.
    pub fn bends_near(&self, at: &Point2<f64>, reach: f64) -> bool {
        self.bends.iter().any(|bend| (bend - at).norm() < reach)
    }

    /// The image position of `p` in pixels; `None` behind the camera.
    pub fn project(&self, p: &Point3<f64>) -> Option<Point2<f64>> {
        self.camera.project(p).map(|pixel| Point2::new(pixel.u, pixel.v))
    }

    fn is_subject(&self, at: &Point2<f64>) -> bool {
        self.camera.ray(at.x, at.y).is_some_and(|ray| self.solid.is_hit(&ray))
    }

    fn nearest_on_chords(&self, at: &Point2<f64>) -> (Point2<f64>, &Segment) {
        self.nearest_within(at, f64::INFINITY).expect("the camera sees the solid")
    }

    /// The nearest chord point less than `reach` pixels from `at`, and its segment.
    fn nearest_within(&self, at: &Point2<f64>, reach: f64) -> Option<(Point2<f64>, &Segment)> {
        let middle = at.y.clamp(0.0, self.rows.len() as f64 - 1.0) as usize;
        let (mut nearest, mut distance) = (None, reach);
        for gap in 0..self.rows.len() {
            // Farther rows hold no nearer segment.
            if gap as f64 - 1.0 > distance {
                break;
            }
            let rows = [middle.checked_sub(gap), Some(middle + gap)];
            for segment in rows.into_iter().flatten().filter_map(|row| self.rows.get(row)).flatten() {
                let point = segment.nearest(at);
                if (point - at).norm() < distance {
                    distance = (point - at).norm();
                    nearest = Some((point, segment));
                }
            }
        }

        nearest
    }

    /// Where the contour crosses the line through `at` along the unit `direction`, at most `reach` pixels away.
    fn crossing(&self, at: &Point2<f64>, direction: &Vector2<f64>, reach: f64) -> Option<Point2<f64>> {
        let ends = [at - direction * reach, at + direction * reach];
        let [first, last] = ends.map(|end| self.is_subject(&end));
        (first != last).then(|| self.bisect(ends[0], ends[1]))
    }

    /// The contour point between two points of which one is subject.
    fn bisect(&self, mut from: Point2<f64>, mut to: Point2<f64>) -> Point2<f64> {
        let first = self.is_subject(&from);
        // Thirty halvings of a pixel leave 1e-9 px.
        for _ in 0..30 {
            let middle = nalgebra::center(&from, &to);
            *(if self.is_subject(&middle) == first { &mut from } else { &mut to }) = middle;
        }
        nalgebra::center(&from, &to)
    }

    fn segments(&self) -> Vec<Segment> {
        let ([x0, y0], [x1, y1]) = self.lattice_rectangle();
        let node = |x: i32, y: i32| Point2::new(f64::from(x) * LATTICE, f64::from(y) * LATTICE);
        let row = |y: i32| (x0..=x1).map(|x| self.is_subject(&node(x, y))).collect::<Vec<_>>();

        let mut above = row(y0);
        let mut segments = Vec::new();
        for y in y0..y1 {
            let below = row(y + 1);
            for x in x0..x1 {
                let k = (x - x0) as usize;
                let subject = [above[k], above[k + 1], below[k + 1], below[k]];
                if subject.contains(&true) && subject.contains(&false) {
                    let nodes = [node(x, y), node(x + 1, y), node(x + 1, y + 1), node(x, y + 1)];
                    self.add_cell(&nodes, &subject, &mut segments);
                }
            }
            above = below;
        }

        segments
    }

    /// Adds the segments in one cell of the lattice. `nodes` are its corners in order around it.
    fn add_cell(&self, nodes: &[Point2<f64>; 4], subject: &[bool; 4], segments: &mut Vec<Segment>) {
        let sides = (0..4).map(|k| (k, (k + 1) % 4)).filter(|&(a, b)| subject[a] != subject[b]);
        let crossings: Vec<_> = sides.map(|(a, b)| self.bisect(nodes[a], nodes[b])).collect();
        for ends in crossings.chunks_exact(2) {
            let along = ends[1] - ends[0];
            // Shorter segments, where the contour passes through a node, have no reliable direction.
            if along.norm() > 1e-3 {
                let across = Vector2::new(along.y, -along.x).normalize();
                let beside = nalgebra::center(&ends[0], &ends[1]) + across * (0.2 * LATTICE);
                let normal = if self.is_subject(&beside) { -across } else { across };
                segments.push(Segment { from: ends[0], to: ends[1], normal });
            }
        }
    }

    /// The rectangle of lattice nodes around the image of the solid's bounding sphere: lower and upper corner.
    fn lattice_rectangle(&self) -> ([i32; 2], [i32; 2]) {
        let (width, height) = self.camera.size();
        let middle = self.camera.project(&self.solid.centre()).expect("the solid is in front of the camera");

        let radius = self.solid.solid().bounding_radius();
        let k = self.camera.intrinsics();
        // Off the axis the image of a sphere is longer, by a factor of 1.1 at 18 degrees.
        let reach = 1.1 * k[(0, 0)].max(k[(1, 1)]) * radius / (middle.depth - radius);

        let low = |x: f64| ((x - reach).max(0.0) / LATTICE).floor() as i32;
        let high = |x: f64, size: u32| ((x + reach).min(f64::from(size)) / LATTICE).ceil() as i32;
        ([low(middle.u), low(middle.v)], [high(middle.u, width), high(middle.v, height)])
    }
}

impl Segment {
    fn nearest(&self, at: &Point2<f64>) -> Point2<f64> {
        let along = self.to - self.from;
        let s = (at - self.from).dot(&along) / along.norm_squared();
        self.from + along * s.clamp(0.0, 1.0)
    }

    fn middle(&self) -> Point2<f64> {
        nalgebra::center(&self.from, &self.to)
    }
}

/// Middles of the segments at which the contour bends.
fn bends(segments: &[Segment]) -> Vec<Point2<f64>> {
    let bend = |a: &Segment, b: &Segment| {
        (a.middle() - b.middle()).norm_squared() < BEND_REACH * BEND_REACH
            && a.normal.dot(&b.normal) < BEND_ANGLE.cos()
    };
    let bent = |segment: &&Segment| segments.iter().any(|other| bend(segment, other));
    segments.iter().filter(bent).map(Segment::middle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry3, point, vector};
    use ode_visual_hull::synthetic::{Solid, Texture};

    fn contour(solid: Solid) -> Contour {
        let camera =
            Camera::look_at("c", (320, 240), 0.5, point![2.4, 0.3, 0.9], Point3::origin(), Vector3::z());
        let pose = Isometry3::new(vector![0.02, 0.01, -0.03], vector![0.4, 0.7, -0.2]);
        Contour::trace(&camera.unwrap(), &Placed::new(solid, pose, Texture::plain([200; 3])))
    }

    #[test]
    fn a_sphere_is_seen_under_the_angle_of_its_cone() {
        let contour = contour(Solid::sphere(0.25).unwrap());
        let to_centre = contour.solid.centre() - contour.centre;
        let half_angle = (0.25 / to_centre.norm()).asin();

        for (u, v) in [(100.0, 100.0), (200.0, 90.0), (170.0, 180.0), (162.0, 110.0)] {
            let on = contour.nearest(&point![u, v]);
            let ray = contour.camera.ray(on.x, on.y).unwrap().direction;
            assert!((ray.angle(&to_centre) - half_angle).abs() < 1e-8);
            // The normal of the cone: away from the axis, square to the ray.
            let expected = (ray * half_angle.cos() - to_centre.normalize()).normalize();
            assert!(contour.normal_in_world(&on).unwrap().angle(&expected) < 1e-4);
            assert!(!contour.bends_near(&on, 7.0));
        }
    }

    #[test]
    fn a_box_bends_at_the_corners_of_its_image_alone() {
        let lengths = vector![0.5, 0.4, 0.3];
        let contour = contour(Solid::cuboid(lengths).unwrap());
        let corner = |c: usize| {
            let sign = |bit: usize| if c >> bit & 1 == 1 { 0.5 } else { -0.5 };
            let local = lengths.component_mul(&vector![sign(0), sign(1), sign(2)]);
            contour.project(&(contour.solid.world_from_solid() * Point3::from(local))).unwrap()
        };
        let off_outline = |at: &Point2<f64>| (contour.nearest(at) - at).norm();

        let corners: Vec<_> = (0..8).map(corner).filter(|corner| off_outline(corner) < 0.3).collect();

        assert_eq!(corners.len(), 6);
        assert!(corners.iter().all(|corner| contour.bends_near(corner, 0.5)));

        let beside = |bend: &Point2<f64>| corners.iter().any(|corner| (corner - bend).norm() < BEND_REACH);
        assert!(contour.bends.iter().all(beside));
        // The silhouette is convex: each corner is joined to two others by lines along the outline.
        for a in &corners {
            let next = |b: &&Point2<f64>| off_outline(&nalgebra::center(a, b)) < 1e-6;
            assert_eq!(corners.iter().filter(|b| *b != a).filter(next).count(), 2);
        }
    }

    #[test]
    fn rays_through_a_torus_contour_graze_the_tube() {
        let contour = contour(Solid::torus(0.25, 0.09).unwrap());
        for segment in contour.rows.iter().flatten().step_by(7) {
            let on = contour.nearest(&segment.middle());
            let ray = contour.solid.world_from_solid().inverse()
                * contour.camera.ray(on.x, on.y).unwrap().direction;
            let eye = contour.solid.world_from_solid().inverse() * contour.centre;
            let from_circle = |t: f64| {
                let p = eye + ray * t;
                (p.x.hypot(p.y) - 0.25).hypot(p.z)
            };
            // Steps of 0.1 mm along the ray find its smallest distance to the circle within the tube to a nanometre.
            let nearest = (0..10_000).map(|k| from_circle(2.0 + f64::from(k) * 1e-4)).fold(1.0, f64::min);
            assert!((nearest - 0.09).abs() < 1e-7, "{on}: {nearest}");
        }
    }
}
