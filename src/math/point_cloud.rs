//! Many points in blocks and in single precision, as the filter takes them.

use nalgebra::{Point3, Vector3};

/// Points asked together.
pub(crate) const LANES: usize = 32;

/// Blocks whose spheres are asked together: a body of 400 samples has 13.
pub(crate) const BLOCKS_PER_GROUP: usize = 16;

/// One number of each of as many points as are asked together.
pub(crate) type Lane = [f32; LANES];

/// Points in a frame of their own, in metres: of a body in the body's frame, or of anything that moves as one.
///
/// Built once, asked often. Coordinates are kept in single precision about the points' middle: a point 10 m from it
/// is rounded by half a micrometre, however far from the world's origin the frame lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    centre: Point3<f64>,
    radius: f64,
    count: usize,
    /// About the middle of all.
    blocks: Vec<Block>,
    /// A sphere around each block's points.
    spheres: Vec<BoundingSpheres>,
    /// The index of each point of the blocks as it was given.
    order: Vec<u32>,
}

/// Points that are asked together. The last block of many is filled up with its last point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(align(64))]
pub(crate) struct Block {
    pub(crate) x: Lane,
    pub(crate) y: Lane,
    pub(crate) z: Lane,
}

/// Spheres around as many blocks as are asked together, about the middle of all points; filled up as blocks are.
#[derive(Debug, Clone, PartialEq)]
#[repr(align(64))]
pub(crate) struct BoundingSpheres {
    pub(crate) x: [f32; BLOCKS_PER_GROUP],
    pub(crate) y: [f32; BLOCKS_PER_GROUP],
    pub(crate) z: [f32; BLOCKS_PER_GROUP],
    pub(crate) radius: [f32; BLOCKS_PER_GROUP],
}

impl Points {
    /// The points, sorted so that neighbours are asked together: where a whole block of them misses the hull, none is
    /// asked. Answers speak of the order given.
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

    /// How many.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Centre and radius of a sphere that holds them, in their frame.
    pub fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        (self.centre, self.radius)
    }

    /// The blocks, with a sphere around each.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = (&BoundingSpheres, &[Block])> {
        self.spheres.iter().zip(self.blocks.chunks(BLOCKS_PER_GROUP))
    }

    /// How many points of a block are points, not filling.
    #[inline(always)]
    pub(crate) fn active_lanes(&self, block: usize) -> usize {
        (self.count - block * LANES).min(LANES)
    }

    /// The index, as given, of a point of the blocks.
    #[inline(always)]
    pub(crate) fn original_index(&self, place: usize) -> usize {
        self.order[place] as usize
    }
}

impl Block {
    fn new(points: &[Point3<f64>], about: &Point3<f64>) -> Self {
        let lane = |axis: usize| -> Lane {
            std::array::from_fn(|k| (points[k.min(points.len() - 1)] - about)[axis] as f32)
        };
        Self { x: lane(0), y: lane(1), z: lane(2) }
    }
}

impl BoundingSpheres {
    fn new(points: &[Point3<f64>], about: &Point3<f64>) -> Self {
        let mut spheres = Self {
            x: [0.0; BLOCKS_PER_GROUP],
            y: [0.0; BLOCKS_PER_GROUP],
            z: [0.0; BLOCKS_PER_GROUP],
            radius: [0.0; BLOCKS_PER_GROUP],
        };
        let last = points.len().div_ceil(LANES) - 1;
        for k in 0..BLOCKS_PER_GROUP {
            let (centre, radius) = sphere(points.chunks(LANES).nth(k.min(last)).unwrap_or(points));
            let middle = (centre - about).cast::<f32>();
            (spheres.x[k], spheres.y[k], spheres.z[k]) = (middle.x, middle.y, middle.z);
            // Rounding moves points and middle by less than this.
            spheres.radius[k] = (radius * (1.0 + 1e-6)) as f32 + 1e-6 * middle.norm();
        }
        spheres
    }
}

/// The sphere about the middle of the points' box.
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

/// Sorts `order` so that blocks of it lie together: halves along the longest side, down to blocks.
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
    let half = (order.len() / 2).next_multiple_of(LANES).min(order.len() - 1);
    order.select_nth_unstable_by(half, |&a, &b| {
        let at = |k: u32| points[k as usize][axis];
        at(a).total_cmp(&at(b)).then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(half);
    split(points, left);
    split(points, right);
}
