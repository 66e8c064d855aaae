//! Samples of an implicit surface, by a grid.
//!
//! ```text
//!      o-----o-----o      o outside, x inside: a grid edge between them crosses the surface. One crossing per crossed
//!      |   / |     |      cell is enough, and a crossing serves the four cells around its edge.
//!      o--*--x--*--o
//! ```

use super::limits::{check_count, finite, spacing};
use super::{Sample, Samples};
use crate::{Error, Result};
use nalgebra::{Point3, Vector3};

/// The largest number of grid nodes, one byte each.
const MAX_NODES: f64 = 6.4e7;

/// Samples of the surface `f = 0` of a solid with `f < 0` inside, within the box `bounds` (lower and upper corner,
/// body frame); `f` is never evaluated outside it. Normals follow the gradient, and are zero where it vanishes.
///
/// The covering radius is guaranteed for surfaces whose radius of curvature is at least `min_feature / 2`; finer parts
/// are found if a node of the grid, whose spacing is a quarter of `min_feature`, lies inside them.
///
/// # Errors
/// A surface that is not found in the bounds, or that leaves them; bounds that are empty or not finite, a
/// `min_feature` that is not finite and positive; too many grid nodes or samples.
pub fn implicit(
    f: impl Fn(Point3<f64>) -> f64,
    bounds: [Point3<f64>; 2],
    min_feature: f64,
) -> Result<Samples> {
    spacing(min_feature)?;
    let grid = Grid::new(&bounds, min_feature)?;
    let inside = grid.inside(&f)?;

    let crossings = grid.needed(grid.crossings(&inside));
    if crossings.is_empty() {
        return Err(grid.fail(
            "no surface found, f is nowhere negative: check the bounds, the sign (f < 0 inside) \
                              and the size of the solid against min_feature",
        ));
    }

    check_count(&grid.name, crossings.len() as f64, min_feature)?;
    let samples = crossings.iter().map(|crossing| grid.sample(&f, &inside, crossing)).collect();
    // The surface bulges out between its samples by at most the covering radius.
    Ok(Samples::new(samples, min_feature / 2.0).widened(min_feature / 2.0))
}

/// A grid edge with one end inside, given by its lower node and its axis.
#[derive(Clone, Copy)]
struct Crossing {
    node: [usize; 3],
    axis: usize,
}

struct Grid {
    name: String,
    min_feature: f64,
    lower: Point3<f64>,
    step: Vector3<f64>,
    cells: [usize; 3],
}

impl Grid {
    fn new(bounds: &[Point3<f64>; 2], min_feature: f64) -> Result<Self> {
        finite("corner of the bounds", bounds)?;
        let [lower, upper] = bounds;
        let size = upper - lower;
        let name = format!("implicit surface in bounds of {} x {} x {} m", size.x, size.y, size.z);
        let mut grid = Self { name, min_feature, lower: *lower, step: size, cells: [0; 3] };
        if size.min() <= 0.0 || !size.iter().all(|x| x.is_finite()) {
            return Err(grid.fail("the bounds are empty: give the lower and the upper corner"));
        }

        // Two points of a cell are at most its diagonal apart. Nine tenths of min_feature / 2 allow for a bulge
        // through a cell face whose corners are all outside: 0.14 steps at a curvature radius of min_feature / 2.
        let step = 0.9 * min_feature / 2.0 / 3.0_f64.sqrt();
        let cells = size.map(|length| (length / step).ceil().max(2.0));
        let nodes = cells.map(|n| n + 1.0).product();
        if nodes > MAX_NODES {
            return Err(grid.fail(&format!(
                "{nodes:.0} grid nodes at min_feature {min_feature} m, at most {MAX_NODES:.0} are allowed: raise \
                 min_feature or tighten the bounds"
            )));
        }

        grid.step = size.component_div(&cells);
        grid.cells = cells.map(|n| n as usize).into();
        Ok(grid)
    }

    fn fail(&self, problem: &str) -> Error {
        Error::argument(format!("{}: {problem}", self.name))
    }

    fn node_index(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * (self.cells[1] + 1) + j) * (self.cells[2] + 1) + k
    }

    fn cell_index(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.cells[1] + j) * self.cells[2] + k
    }

    fn point(&self, node: [usize; 3]) -> Point3<f64> {
        self.lower + self.step.component_mul(&Vector3::from(node.map(|n| n as f64)))
    }

    fn nodes(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let [nx, ny, nz] = self.cells;
        (0..=nx).flat_map(move |i| (0..=ny).flat_map(move |j| (0..=nz).map(move |k| [i, j, k])))
    }

    /// Whether each node is inside. Nodes on the border must be outside: a solid that leaves the bounds would have a
    /// hole there.
    fn inside(&self, f: &impl Fn(Point3<f64>) -> f64) -> Result<Vec<bool>> {
        let mut inside = Vec::with_capacity(self.node_index(self.cells) + 1);
        for node in self.nodes() {
            let point = self.point(node);
            inside.push(f(point) < 0.0);
            if inside.ends_with(&[true])
                && (0..3).any(|axis| node[axis] == 0 || node[axis] == self.cells[axis])
            {
                return Err(self.fail(&format!(
                    "the solid leaves the bounds at ({:.3}, {:.3}, {:.3}): widen them",
                    point.x, point.y, point.z
                )));
            }
        }
        Ok(inside)
    }

    fn crossings(&self, inside: &[bool]) -> Vec<Crossing> {
        let mut crossings = Vec::new();
        for node in self.nodes() {
            for axis in (0..3).filter(|axis| node[*axis] < self.cells[*axis]) {
                let mut next = node;
                next[axis] += 1;
                if inside[self.node_index(node)] != inside[self.node_index(next)] {
                    crossings.push(Crossing { node, axis });
                }
            }
        }
        crossings
    }

    /// The four cells around a crossing's edge. They exist, since an edge on the border has no end inside.
    fn cells_around(&self, crossing: &Crossing) -> [usize; 4] {
        let (u, v) = ((crossing.axis + 1) % 3, (crossing.axis + 2) % 3);
        [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(du, dv)| {
            let mut cell = crossing.node;
            cell[u] -= du;
            cell[v] -= dv;
            self.cell_index(cell)
        })
    }

    /// A subset of the crossings with at least one in every crossed cell, chosen greedily by the number of cells
    /// covered.
    fn needed(&self, crossings: Vec<Crossing>) -> Vec<Crossing> {
        let mut covered = vec![false; self.cells.iter().product()];
        let mut needed = vec![false; crossings.len()];

        for least in (1..=4).rev() {
            for (needed, crossing) in needed.iter_mut().zip(&crossings) {
                let cells = self.cells_around(crossing);
                if cells.iter().filter(|cell| !covered[**cell]).count() >= least {
                    *needed = true;
                    cells.iter().for_each(|cell| covered[*cell] = true);
                }
            }
        }
        crossings
            .into_iter()
            .zip(needed)
            .filter_map(|(crossing, needed)| needed.then_some(crossing))
            .collect()
    }

    /// The surface point on a crossing's edge, by bisection on the sign of `f`.
    fn sample(&self, f: &impl Fn(Point3<f64>) -> f64, inside: &[bool], crossing: &Crossing) -> Sample {
        let mut end = crossing.node;
        end[crossing.axis] += 1;
        let (mut inner, mut outer) = (self.point(crossing.node), self.point(end));
        if !inside[self.node_index(crossing.node)] {
            std::mem::swap(&mut inner, &mut outer);
        }

        // Each step halves the distance: after 60 it is below the spacing of floats.
        for _ in 0..60 {
            let middle = nalgebra::center(&inner, &outer);
            *(if f(middle) < 0.0 { &mut inner } else { &mut outer }) = middle;
        }

        Sample { point: outer, normal: self.normal(f, &outer) }
    }

    /// The gradient's direction by central differences over a step at which rounding and curvature are small.
    fn normal(&self, f: &impl Fn(Point3<f64>) -> f64, at: &Point3<f64>) -> Vector3<f64> {
        let reach = 1e-4 * self.min_feature;
        let upper = self.lower + self.step.component_mul(&Vector3::from(self.cells.map(|n| n as f64)));
        let slope = |axis: usize| {
            let (mut ahead, mut behind) = (*at, *at);
            ahead[axis] = (at[axis] + reach).min(upper[axis]);
            behind[axis] = (at[axis] - reach).max(self.lower[axis]);
            (f(ahead) - f(behind)) / (ahead[axis] - behind[axis])
        };
        let gradient = Vector3::new(slope(0), slope(1), slope(2));
        let largest = gradient.amax();
        if largest.is_finite() && largest > 0.0 { (gradient / largest).normalize() } else { Vector3::zeros() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_covers, assert_unit_normals};
    use super::*;

    fn around(radius: f64) -> [Point3<f64>; 2] {
        [Point3::new(-radius, -radius * 1.1, -radius * 1.2), Point3::new(radius, radius * 1.3, radius)]
    }

    #[test]
    fn an_implicit_sphere_is_covered_with_analytic_normals() {
        for radius in [0.016, 0.05, 0.21] {
            let samples = implicit(|p| p.coords.norm() - radius, around(radius), 0.03).unwrap();
            assert_covers(&samples, 0.03, |random| Point3::from(random.direction() * radius));
            assert_unit_normals(&samples);
            for Sample { point, normal } in samples.points() {
                assert!((point.coords.norm() - radius).abs() < 1e-12);
                // Errors of differences over 6 micrometres: rounding 1e-17 / 6e-6, curvature (3e-6 / radius)^2.
                assert!((point.coords / radius - normal).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn a_torus_is_covered() {
        let (ring, tube) = (0.2, 0.05);
        let f = |p: Point3<f64>| (p.coords.xy().norm() - ring).hypot(p.z) - tube;
        let samples = implicit(f, [Point3::new(-0.3, -0.3, -0.1), Point3::new(0.3, 0.3, 0.1)], 0.04).unwrap();
        assert_covers(&samples, 0.04, |random| {
            let ((a, b), (c, d)) = (random.between(0.0, 7.0).sin_cos(), random.between(0.0, 7.0).sin_cos());
            Point3::new((ring + tube * a) * c, (ring + tube * a) * d, tube * b)
        });
        // Compare with a square grid of spacing D / sqrt 2.
        let grid = 4.0 * std::f64::consts::PI.powi(2) * ring * tube * 2.0 / 0.04_f64.powi(2);
        assert!((samples.points().len() as f64) < 5.0 * grid, "{} {grid}", samples.points().len());
    }

    #[test]
    fn surfaces_that_cannot_be_closed_are_refused() {
        let ball = |p: Point3<f64>| p.coords.norm() - 0.1;
        let message = |bounds, d| implicit(ball, bounds, d).unwrap_err().to_string();
        let at = |x: f64| Point3::new(x, x, x);
        assert!(message([at(0.2), at(0.4)], 0.03).contains("no surface found"));
        assert!(message([at(0.0), at(0.4)], 0.03).contains("leaves the bounds"));
        assert!(message([at(-0.01), at(0.01)], 0.03).contains("leaves the bounds"));
        assert!(message([at(0.4), at(-0.4)], 0.03).contains("empty"));
        assert!(message([at(-0.4), at(0.4)], 1e-4).contains("raise min_feature"));
        assert!(message([at(-0.4), at(f64::NAN)], 0.03).contains("finite"));
        assert!(implicit(|_| f64::NAN, [at(-0.4), at(0.4)], 0.03).is_err());
    }
}
