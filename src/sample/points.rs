//! Samples given by the user.

use super::limits::{MAX_SAMPLES, finite};
use super::{Sample, Samples};
use crate::{Error, Result};
use nalgebra::{Point3, Vector3};

/// Samples from a user's own surface points with their outward normals, both in the body's frame; `None` if the
/// normals are unknown. Normals need not have unit length; a zero normal means unknown.
///
/// # Errors
/// No points or more than [`MAX_SAMPLES`], another number of normals than of points, a number that is not finite.
pub fn from_points(points: &[Point3<f64>], normals: Option<&[Vector3<f64>]>) -> Result<Samples> {
    if points.is_empty() || points.len() > MAX_SAMPLES {
        let count = points.len();
        return Err(Error::argument(format!("{count} surface samples given: give 1 to {MAX_SAMPLES}")));
    }
    finite("surface sample", points)?;

    let Some(normals) = normals else {
        let samples = points.iter().map(|point| Sample { point: *point, normal: Vector3::zeros() });
        return Ok(Samples::new(samples.collect(), f64::INFINITY));
    };

    if normals.len() != points.len() {
        let (expected, found) = (points.len(), normals.len());
        return Err(Error::argument(format!(
            "{expected} surface samples need {expected} normals, found {found}: give one per sample, or none at all"
        )));
    }

    let unit = |(index, normal): (usize, &Vector3<f64>)| {
        // Scale first: the squares of very long or very short vectors leave the range of floats.
        let longest = normal.amax();
        if !normal.iter().all(|x| x.is_finite()) {
            return Err(Error::argument(format!(
                "normal {index} is ({}, {}, {}): give finite numbers, or zeros for a normal that is not known",
                normal.x, normal.y, normal.z
            )));
        }
        Ok(if longest > 0.0 { (normal / longest).normalize() } else { Vector3::zeros() })
    };

    let normals = normals.iter().enumerate().map(unit).collect::<Result<Vec<_>>>()?;
    let samples = points.iter().zip(normals).map(|(point, normal)| Sample { point: *point, normal });
    Ok(Samples::new(samples.collect(), f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_become_unit_or_stay_unknown() {
        let points = [Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 2.0, 0.0)];
        let samples = from_points(&points, Some(&[Vector3::x() * 1e-200, Vector3::zeros()])).unwrap();
        assert_eq!(samples.points()[0].normal, Vector3::x());
        assert_eq!(samples.points()[1].normal, Vector3::zeros());
        assert_eq!(samples.bounding_radius(), 2.0);
        assert!(samples.smooth().is_none() && samples.covering_radius().is_infinite());
        let bare = from_points(&points, None).unwrap();
        assert!(bare.points().iter().all(|s| s.normal == Vector3::zeros()));
    }

    #[test]
    fn unusable_points_are_refused() {
        let point = Point3::new(0.0, 1.0, 0.0);
        assert!(from_points(&[], None).is_err());
        assert!(from_points(&[Point3::new(0.0, f64::NAN, 0.0)], None).is_err());
        assert!(from_points(&[point], Some(&[Vector3::new(f64::INFINITY, 0.0, 0.0)])).is_err());
        let error = from_points(&[point], Some(&[])).unwrap_err().to_string();
        assert!(error.contains("1 normals, found 0"), "{error}");
    }
}
