//! Triangles of the virtual bodies as pixels, with a depth buffer.

use crate::scene::{Mesh, Scene, Vertex};
use nalgebra::{Isometry3, Matrix3x4, Point3, RowVector4, Vector3};
use std::ops::Range;

/// What lies nearer to a viewpoint than this, in metres, is cut off.
const NEAR: f32 = 0.02;

/// From the world to an image.
#[derive(Debug, Clone)]
pub struct Projection {
    /// To homogeneous image coordinates in pixels.
    pub image: Matrix3x4<f32>,
    /// To the depth that is compared, in metres.
    pub depth: RowVector4<f32>,
}

/// What of a body a pixel shows.
#[derive(Debug, Clone, Copy)]
pub struct Fragment {
    /// Its depth in metres; infinite where no body is.
    pub depth: f32,
    /// The outward unit normal in the world.
    pub normal: Vector3<f32>,
    /// The body's colour, as it is lit.
    pub colour: Vector3<f32>,
}

impl Default for Fragment {
    fn default() -> Self {
        Self { depth: f32::INFINITY, normal: Vector3::zeros(), colour: Vector3::zeros() }
    }
}

/// The triangles of all bodies in the world.
#[derive(Debug, Default)]
pub struct Triangles(Vec<Triangle>);

/// The triangles of all bodies in an image.
pub struct ImageTriangles(Vec<Setup>);

#[derive(Debug, Clone, Copy)]
struct Triangle {
    corners: [Corner; 3],
    colour: Vector3<f32>,
}

#[derive(Debug, Clone, Copy)]
struct Corner {
    position: Point3<f32>,
    normal: Vector3<f32>,
    brightness: f32,
}

/// A corner in an image.
#[derive(Debug, Clone, Copy)]
struct Projected {
    /// Image coordinates times `w`, and `w`.
    image: Vector3<f32>,
    depth: f32,
    normal: Vector3<f32>,
    brightness: f32,
}

impl Triangles {
    /// The triangles of the bodies of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let of_body = |body: &ode_visual_hull_film::Drawn| {
            let (mesh, pose) = (Mesh::of(&body.shape), body.world_from_body.cast::<f32>());
            let colour = Vector3::from(body.colour.map(f32::from));
            let corner = |vertex: Vertex| Corner::new(&vertex, &pose);
            let corners = |triangle: &[u32; 3]| triangle.map(|index| corner(mesh.vertices[index as usize]));
            let triangles =
                mesh.triangles.iter().map(|triangle| Triangle { corners: corners(triangle), colour });
            triangles.collect::<Vec<_>>()
        };
        Self(scene.bodies.iter().flat_map(of_body).collect())
    }

    /// The corners' positions.
    pub fn points(&self) -> impl Iterator<Item = &Point3<f32>> {
        self.0.iter().flat_map(|triangle| &triangle.corners).map(|corner| &corner.position)
    }

    /// The triangles as an image shows them.
    pub fn in_image(&self, projection: &Projection) -> ImageTriangles {
        let projected = |triangle: &Triangle| {
            let corners = triangle.corners.map(|corner| corner.projected(projection));
            let colour = triangle.colour;
            clipped(&corners).map(move |corners| Setup::new(corners, colour))
        };
        ImageTriangles(self.0.iter().flat_map(projected).flatten().collect())
    }
}

impl ImageTriangles {
    /// What each pixel of these `rows` of an image shows, whose rows have `width` pixels; in place of what is in `fragments`.
    pub fn draw(&self, width: usize, rows: &Range<usize>, fragments: &mut Vec<Fragment>) {
        fragments.clear();
        fragments.resize(width * rows.len(), Fragment::default());
        for setup in &self.0 {
            setup.fill(fragments, width, rows);
        }
    }
}

impl Corner {
    fn new(vertex: &Vertex, world_from_body: &Isometry3<f32>) -> Self {
        Self {
            position: world_from_body * vertex.position,
            normal: world_from_body * vertex.normal,
            brightness: vertex.brightness,
        }
    }

    fn projected(&self, projection: &Projection) -> Projected {
        let point = self.position.to_homogeneous();
        Projected {
            image: projection.image * point,
            depth: (projection.depth * point).x,
            normal: self.normal,
            brightness: self.brightness,
        }
    }
}

/// The part of a triangle in front of the viewpoint, as up to two triangles.
fn clipped(corners: &[Projected; 3]) -> impl Iterator<Item = [Projected; 3]> + use<> {
    let mut kept = [corners[0]; 4];
    let mut count = 0;
    for k in 0..3 {
        let (from, to) = (&corners[k], &corners[(k + 1) % 3]);
        if from.image.z >= NEAR {
            kept[count] = *from;
            count += 1;
        }
        if (from.image.z >= NEAR) != (to.image.z >= NEAR) {
            kept[count] = from.towards(to, (NEAR - from.image.z) / (to.image.z - from.image.z));
            count += 1;
        }
    }
    (2..count).map(move |k| [kept[0], kept[k - 1], kept[k]])
}

impl Projected {
    fn towards(&self, other: &Self, part: f32) -> Self {
        Self {
            image: self.image.lerp(&other.image, part),
            depth: self.depth + (other.depth - self.depth) * part,
            normal: self.normal.lerp(&other.normal, part),
            brightness: self.brightness + (other.brightness - self.brightness) * part,
        }
    }
}

/// A triangle in an image, ready to be filled.
struct Setup {
    corners: [Projected; 3],
    /// The corners' image positions.
    at: [(f32, f32); 3],
    /// Twice the signed area in pixels.
    area: f32,
    colour: Vector3<f32>,
}

impl Setup {
    /// `None` for a triangle without area, or one that is seen from inside.
    fn new(corners: [Projected; 3], colour: Vector3<f32>) -> Option<Self> {
        let at = corners.map(|corner| (corner.image.x / corner.image.z, corner.image.y / corner.image.z));
        // Rows go down, so that what is counter-clockwise in the world is clockwise in the image.
        let area = edge(at[0], at[2], at[1]);
        (area > 0.0).then_some(Self { corners, at, area, colour })
    }

    /// Draws the triangle into `fragments`, which hold these rows of the image.
    fn fill(&self, fragments: &mut [Fragment], width: usize, rows: &Range<usize>) {
        let [a, b, c] = self.at;
        let range = |a: f32, b: f32, c: f32, from: usize, to: usize| {
            let low = (a.min(b).min(c) - 0.5).ceil().max(from as f32) as usize;
            let high = (a.max(b).max(c) - 0.5).floor().min(to as f32 - 1.0);
            if high < from as f32 { low..low } else { low..high as usize + 1 }
        };
        for y in range(a.1, b.1, c.1, rows.start, rows.end) {
            for x in range(a.0, b.0, c.0, 0, width) {
                let Some(found) = self.at((x as f32 + 0.5, y as f32 + 0.5)) else { continue };
                let fragment = &mut fragments[(y - rows.start) * width + x];
                if found.depth < fragment.depth {
                    *fragment = found;
                }
            }
        }
    }

    /// What the triangle shows at an image position, if it is there.
    fn at(&self, p: (f32, f32)) -> Option<Fragment> {
        let [a, b, c] = self.at;
        let parts = [edge(c, b, p), edge(a, c, p), edge(b, a, p)];
        if parts.iter().any(|part| *part < 0.0) {
            return None;
        }

        // What is linear in the world is linear over depth in the image.
        let weights = [0, 1, 2].map(|k| parts[k] / (self.area * self.corners[k].image.z));
        let total: f32 = weights.iter().sum();
        let mix = |of: fn(&Projected) -> f32| {
            self.corners.iter().zip(weights).map(|(corner, weight)| of(corner) * weight).sum::<f32>() / total
        };
        let normal: Vector3<f32> =
            self.corners.iter().zip(weights).map(|(c, weight)| c.normal * weight).sum();
        Some(Fragment {
            depth: mix(|corner| corner.depth),
            normal: normal.normalize(),
            colour: self.colour * mix(|corner| corner.brightness),
        })
    }
}

/// Twice the area of the triangle `a`, `b`, `p`, positive where `p` lies on the right of the line from `a` to `b` as the
/// image shows it.
fn edge(a: (f32, f32), b: (f32, f32), p: (f32, f32)) -> f32 {
    (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0)
}
