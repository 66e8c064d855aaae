//! Mass, centre of mass and inertia of solids.

use nalgebra::{Cholesky, Matrix3, Point3, UnitQuaternion, Vector3};
use ode_sys::dMass;

use super::shape::checked;
use super::{check, convert};
use crate::shape::Shape;
use crate::{Error, Result};

/// The amount of matter in a homogeneous solid, as its mass or its density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// The total mass, kg.
    Total(f64),
    /// The density, kg/m³.
    Density(f64),
}

/// Mass, centre of mass and inertia of a solid, in a body's frame.
///
/// A body accepts only a mass whose centre is at its origin; [`centred`](Self::centred) moves it there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    total: f64,
    center: Vector3<f64>,
    /// The inertia about the frame's origin, not about the centre of mass.
    inertia: Matrix3<f64>,
}

impl Mass {
    /// A mass of `total` kg with its centre at `center` and with this inertia about the frame's origin, kg m².
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if a number is not finite, if the mass is not positive, or if the inertia, about the origin
    /// or about the centre of mass, is not symmetric and positive definite.
    pub fn new(total: f64, center: Point3<f64>, inertia: Matrix3<f64>) -> Result<Self> {
        check::positive("mass", total)?;
        check::point("centre of mass", &center)?;

        let symmetric = (inertia + inertia.transpose()) / 2.0;
        if !inertia.iter().all(|x| x.is_finite()) || (inertia - symmetric).norm() > 1e-9 * inertia.norm() {
            return Err(Error::argument(format!(
                "inertia: expected a symmetric, finite matrix, found {inertia:?}"
            )));
        }

        Self { total, center: center.coords, inertia: symmetric }.checked()
    }

    /// The mass of a homogeneous solid of this shape. A mesh must be closed, with its triangles facing outwards.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] for an amount that is not positive and finite, for sizes out of range, and for shapes
    /// without volume: planes, rays, heightfields, and meshes whose signed volume is not positive.
    pub fn of(shape: &Shape, amount: Amount) -> Result<Self> {
        let unit = Self::of_unit_density(&checked(shape)?)?;
        let total = match amount {
            Amount::Total(total) => check::positive("mass", total)?,
            Amount::Density(density) => check::positive("density", density)? * unit.total,
        };
        let scale = total / unit.total;
        Self { total, center: unit.center, inertia: unit.inertia * scale }.checked()
    }

    /// The total mass, kg.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// The centre of mass, in the body's frame.
    pub fn center(&self) -> Point3<f64> {
        self.center.into()
    }

    /// The inertia about the frame's origin, kg m².
    pub fn inertia(&self) -> Matrix3<f64> {
        self.inertia
    }

    /// The mass of this solid after a translation.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the translation is not finite, or so long that roundoff makes the inertia indefinite.
    pub fn translated(&self, by: &Vector3<f64>) -> Result<Self> {
        check::vector("translation of the mass", by)?;
        let center = self.center + by;
        let inertia = self.inertia_about_center() - self.total * cross_squared(&center);
        Self { total: self.total, center, inertia }.checked()
    }

    /// The mass of this solid after its centre of mass was moved to the origin.
    pub fn centred(&self) -> Self {
        Self { total: self.total, center: Vector3::zeros(), inertia: self.inertia_about_center() }
    }

    /// The mass of this solid after a rotation about the frame's origin.
    ///
    /// A quaternion that is not of unit length gives a mass without a finite inertia, which every function that takes one
    /// refuses.
    pub fn rotated(&self, by: &UnitQuaternion<f64>) -> Self {
        if check::rotation("", by).is_err() {
            return Self { inertia: Matrix3::repeat(f64::NAN), ..*self };
        }
        let rotation = by.to_rotation_matrix();
        let inertia = rotation.matrix() * self.inertia * rotation.matrix().transpose();
        let inertia = (inertia + inertia.transpose()) / 2.0;
        Self { total: self.total, center: by * self.center, inertia }
    }

    /// The mass of a solid of this shape and density distribution with another total mass, in kg.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if `total` is not positive and finite.
    pub fn adjusted(&self, total: f64) -> Result<Self> {
        check::positive("mass", total)?;
        Self { total, center: self.center, inertia: self.inertia * (total / self.total) }.checked()
    }

    /// The mass of both solids as one rigid solid.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the sum is not finite.
    pub fn combined(&self, other: &Self) -> Result<Self> {
        let total = self.total + other.total;
        let center = (self.center * self.total + other.center * other.total) / total;
        Self { total, center, inertia: self.inertia + other.inertia }.checked()
    }

    /// The mass of a solid with a density of 1 kg/m³.
    fn of_unit_density(shape: &Shape) -> Result<Self> {
        use std::f64::consts::PI;

        let solid = |total: f64, [x, y, z]: [f64; 3]| Self {
            total,
            center: Vector3::zeros(),
            inertia: Matrix3::from_diagonal(&Vector3::new(x, y, z)),
        };

        // Moments of inertia about the centre, in each shape's own frame.
        Ok(match shape {
            Shape::Sphere { radius } => {
                let total = 4.0 / 3.0 * PI * radius.powi(3);
                solid(total, [0.4 * total * radius * radius; 3])
            }
            Shape::Box { sides } => {
                let total = sides.product();
                let [xx, yy, zz] = [sides.x.powi(2), sides.y.powi(2), sides.z.powi(2)];
                solid(total, [yy + zz, xx + zz, xx + yy].map(|sum| total * sum / 12.0))
            }
            Shape::Cylinder { radius, length } => {
                let rr = radius * radius;
                let total = PI * rr * length;
                let across = total * (rr / 4.0 + length * length / 12.0);
                solid(total, [across, across, total * rr / 2.0])
            }
            Shape::Capsule { radius, length } => {
                let (r, l) = (*radius, *length);
                let (middle, caps) = (PI * r * r * l, 4.0 / 3.0 * PI * r.powi(3));
                // The cylinder, and two half balls moved by the parallel axis theorem.
                let across = middle * (r * r / 4.0 + l * l / 12.0)
                    + caps * (0.4 * r * r + 0.375 * r * l + 0.25 * l * l);
                solid(middle + caps, [across, across, (middle * 0.5 + caps * 0.4) * r * r])
            }
            Shape::Convex(convex) => {
                // Each face as a fan of triangles around its first point.
                let fan = convex
                    .faces()
                    .flat_map(|face| face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]]));
                Self::of_surface(convex.points(), fan)?
            }
            Shape::TriMesh(mesh) => Self::of_surface(mesh.points(), mesh.triangles().iter().copied())?,
            Shape::Plane { .. } | Shape::Ray { .. } | Shape::Heightfield(_) => {
                return Err(Error::argument(format!(
                    "mass: expected a solid, found {shape:?}, which has no inside"
                )));
            }
        })
    }

    /// The mass of the solid inside a closed triangle surface, with a density of 1 kg/m³.
    ///
    /// It is a sum over signed tetrahedra, each between the origin and a triangle.
    fn of_surface(points: &[Point3<f64>], triangles: impl Iterator<Item = [u32; 3]>) -> Result<Self> {
        // The integrals of 1, x and x x^T over the solid.
        let (mut volume, mut moment, mut second_moment) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for triangle in triangles {
            let [a, b, c] = triangle.map(|index| points[index as usize].coords);
            let six_volumes = a.dot(&b.cross(&c));
            let sum = a + b + c;
            volume += six_volumes / 6.0;
            moment += six_volumes / 24.0 * sum;
            let outer = a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose();
            second_moment += six_volumes / 120.0 * outer;
        }

        if volume <= 0.0 || !volume.is_finite() {
            return Err(Error::argument(format!(
                "mass: expected a closed mesh whose triangles face outwards, found a volume of {volume} m^3"
            )));
        }

        let inertia = Matrix3::identity() * second_moment.trace() - second_moment;
        Ok(Self { total: volume, center: moment / volume, inertia })
    }

    /// The inertia about the centre of mass, by the parallel axis theorem.
    fn inertia_about_center(&self) -> Matrix3<f64> {
        self.inertia + self.total * cross_squared(&self.center)
    }

    /// Refuses a mass that is not positive and an inertia that is not positive definite.
    fn checked(self) -> Result<Self> {
        check::positive("mass", self.total)?;
        if !self.inertia.iter().all(|x| x.is_finite()) {
            return Err(Error::argument(
                "inertia: expected finite numbers, found NaN; a mass that was turned by a quaternion that is not of unit \
                 length has such",
            ));
        }
        let definite = |inertia: Matrix3<f64>| Cholesky::new(inertia).is_some();
        if definite(self.inertia) && definite(self.inertia_about_center()) {
            Ok(self)
        } else {
            Err(Error::argument(format!(
                "inertia: expected a positive definite matrix about the origin and the centre of mass, found {:?}",
                self.inertia
            )))
        }
    }

    /// The mass as ODE's structure for a body.
    ///
    /// # Errors
    ///
    /// [`Error::Argument`] if the centre of mass is not at the origin, or the inertia not finite, for which ODE would
    /// abort.
    pub(super) fn to_ode(self) -> Result<dMass> {
        self.checked()?;
        let radius = (self.inertia.trace() / self.total).sqrt();
        if self.center.norm() > 1e-9 * radius {
            let [x, y, z] = [self.center.x, self.center.y, self.center.z];
            return Err(Error::argument(format!(
                "mass: expected its centre at the body's origin, found ({x}, {y}, {z}); \
                 use `centred` and offset the geoms"
            )));
        }

        let centred = self.centred();
        Ok(dMass { mass: self.total, c: [0.0; 4], I: convert::ode_matrix(&centred.inertia) })
    }

    /// The mass in ODE's structure.
    pub(super) fn from_ode(mass: &dMass) -> Self {
        Self { total: mass.mass, center: convert::vector(&mass.c), inertia: convert::matrix(&mass.I) }
    }
}

/// The square of the cross-product matrix of `v`: minus the inertia that 1 kg at `v` has about the origin.
fn cross_squared(v: &Vector3<f64>) -> Matrix3<f64> {
    v * v.transpose() - Matrix3::identity() * v.norm_squared()
}

#[cfg(test)]
mod tests;
