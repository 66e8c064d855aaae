//! Many points in blocks and in single precision, as the filter in `hull::cull` reads them.

use nalgebra::{Point3, Vector3};

/// Number of points in a block, which are processed side by side.
pub(crate) const LANES: usize = 32;

/// Number of blocks whose bounding spheres are tested side by side: a body of 400 samples has 13 blocks.
pub(crate) const BLOCKS_PER_GROUP: usize = 16;

/// One number for each point of a block.
pub(crate) type Lane = [f32; LANES];

/// Points in a frame of their own, in metres: those of a body in the body's frame, or of anything else that is rigid.
///
/// They are built once and queried often. Coordinates are stored in single precision relative to the points' middle: a
/// point 10 m from it is rounded by half a micrometre, however far from the world's origin the frame lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    centre: Point3<f64>,
    radius: f64,
    count: usize,
    /// Coordinates relative to the middle of all points.
    blocks: Vec<Block>,
    /// A sphere around each block's points.
    spheres: Vec<BoundingSpheres>,
    /// For each point of the blocks its index in the list that was passed to `new`.
    order: Vec<u32>,
}

/// A block of `LANES` points. The last block of a list is padded with its last point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Block {
    pub(crate) x: Lane,
    pub(crate) y: Lane,
    pub(crate) z: Lane,
}

/// The bounding spheres of a group of blocks, relative to the middle of all points; padded with the last sphere.
#[derive(Debug, Clone, PartialEq)]
#[repr(align(64))]
pub(crate) struct BoundingSpheres {
    pub(crate) x: [f32; BLOCKS_PER_GROUP],
    pub(crate) y: [f32; BLOCKS_PER_GROUP],
    pub(crate) z: [f32; BLOCKS_PER_GROUP],
    pub(crate) radius: [f32; BLOCKS_PER_GROUP],
}

impl Points {
    /// Sorts `points` so that neighbours share a block: where the sphere around a block misses the hull, none of its
    /// points has to be projected. Results of queries name the points by their indices in `points`.
    pub fn new(points: &[Point3<f64>]) -> Self {
        let (centre, radius) = sphere(points);
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        split(points, &mut order);
        let sorted: Vec<_> = order.iter().map(|&k| points[k as usize]).collect();
        let blocks = sorted.chunks(LANES).map(|block| Block::new(block, &centre)).collect();
        let spheres = sorted
            .chunks(LANES * BLOCKS_PER_GROUP)
            .map(|blocks| BoundingSpheres::new(blocks, &centre))
            .collect();
        Self { centre, radius, count: points.len(), blocks, spheres, order }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Centre and radius, in metres, of a sphere that holds the points, in their frame.
    pub fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        (self.centre, self.radius)
    }

    /// The groups of blocks, each with its blocks' bounding spheres.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (&BoundingSpheres, &[Block])> {
        self.spheres.iter().zip(self.blocks.chunks(BLOCKS_PER_GROUP))
    }

    /// Number of points in a block, without the padding.
    #[inline(always)]
    pub(crate) fn active_lanes(&self, block: usize) -> usize {
        (self.count - block * LANES).min(LANES)
    }

    /// The point at `place` of the blocks, as rounded there.
    pub(crate) fn at(&self, place: usize) -> Point3<f64> {
        let (block, k) = (&self.blocks[place / LANES], place % LANES);
        self.centre + Vector3::new(block.x[k], block.y[k], block.z[k]).cast::<f64>()
    }

    /// The index, in the list that was passed to `new`, of the point at `place` of the blocks.
    #[inline(always)]
    pub(crate) fn original_index(&self, place: usize) -> usize {
        self.order[place] as usize
    }
}

impl Block {
    fn new(points: &[Point3<f64>], origin: &Point3<f64>) -> Self {
        let lane = |axis: usize| -> Lane {
            std::array::from_fn(|k| (points[k.min(points.len() - 1)] - origin)[axis] as f32)
        };
        Self { x: lane(0), y: lane(1), z: lane(2) }
    }
}

impl BoundingSpheres {
    fn new(points: &[Point3<f64>], origin: &Point3<f64>) -> Self {
        let mut spheres = Self {
            x: [0.0; BLOCKS_PER_GROUP],
            y: [0.0; BLOCKS_PER_GROUP],
            z: [0.0; BLOCKS_PER_GROUP],
            radius: [0.0; BLOCKS_PER_GROUP],
        };

        let last = points.len().div_ceil(LANES) - 1;
        for k in 0..BLOCKS_PER_GROUP {
            let (centre, radius) = sphere(points.chunks(LANES).nth(k.min(last)).unwrap_or(points));
            let middle = (centre - origin).cast::<f32>();
            (spheres.x[k], spheres.y[k], spheres.z[k]) = (middle.x, middle.y, middle.z);

            // Rounding to single precision moves the points and the centre by less than the two margins.
            spheres.radius[k] = (radius * (1.0 + 1e-6)) as f32 + 1e-6 * middle.norm();
        }
        spheres
    }
}

/// Centre and radius of the sphere around the points whose centre is the middle of their box.
fn sphere(points: &[Point3<f64>]) -> (Point3<f64>, f64) {
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for p in points {
        (low, high) = (low.inf(&p.coords), high.sup(&p.coords));
    }
    if points.is_empty() {
        return (Point3::origin(), 0.0);
    }
    let centre = Point3::from(low * 0.5 + high * 0.5);
    (centre, points.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max))
}

/// Sorts `order` so that the points of each block lie close together: it is halved across the longest side of its box,
/// recursively down to blocks.
fn split(points: &[Point3<f64>], order: &mut [u32]) {
    if order.len() <= LANES {
        return;
    }

    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for &k in order.iter() {
        let p = points[k as usize].coords;
        (low, high) = (low.inf(&p), high.sup(&p));
    }
    let axis = (high - low).imax();

    // The left half holds whole blocks, and equal coordinates are ordered by index, so that the result is unique.
    let half = (order.len() / 2).next_multiple_of(LANES).min(order.len() - 1);
    order.select_nth_unstable_by(half, |&a, &b| {
        let at = |k: u32| points[k as usize][axis];
        at(a).total_cmp(&at(b)).then(a.cmp(&b))
    });

    let (left, right) = order.split_at_mut(half);
    split(points, left);
    split(points, right);
}
