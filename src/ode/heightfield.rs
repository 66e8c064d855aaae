//! ODE's data of heightfields, and what its collider for them gets wrong.
//!
//! ODE 0.16 visits every cell under the box of the other geom, compares all triangles there with each other, and aborts
//! where the range of cells is empty or overflows a C int. So pairs are checked first. Of its contacts those are
//! dropped that are none.

use nalgebra::{Point3, Vector3};
use ode_sys::{
    dBoxClass, dCapsuleClass, dConvexClass, dCylinderClass, dGeomGetClass, dGeomHeightfieldDataBuildDouble,
    dGeomHeightfieldDataCreate, dGeomHeightfieldDataDestroy, dGeomID, dGeomRayGet, dHeightfieldClass,
    dHeightfieldDataID, dRayClass, dSphereClass, dTriMeshClass,
};

use super::arena::GeomId;
use super::contacts::{ContactGeom, Contacts};
use super::convert;
use super::world::World;
use crate::shape::{Heightfield, Shape};
use crate::{Error, Result};

/// The largest number of cells under a geom. ODE's time grows with the square; here it is half a second at worst.
const MOST_CELLS: f64 = 4096.0;

/// Cell numbers up to this one are far from the limits of a C int.
const LARGEST_CELL: f64 = 1e9;

/// The distance of a hit from its ray that is roundoff, as a part of the coordinates.
const ROUNDOFF: f64 = 1e-9;

/// ODE's data of a heightfield. It refers to the heights, so its owner must keep the heightfield.
#[derive(Debug)]
pub(super) struct HeightData(dHeightfieldDataID);

impl HeightData {
    /// Describes `field` to ODE.
    ///
    /// # Safety
    ///
    /// ODE is open, and `field` is neither moved nor dropped before the returned value is.
    pub(super) unsafe fn build(field: &Heightfield) -> Result<Self> {
        // SAFETY: ODE is open.
        let id = unsafe { dGeomHeightfieldDataCreate() };
        if id.is_null() {
            return Err(Error::Ode("memory ran out for the data of a heightfield".into()));
        }
        let data = Self(id);

        let ([width, depth], [columns, rows]) = (field.size(), field.counts());
        // SAFETY: there are as many heights as columns and rows say, which fit a C int, and the caller keeps them; all
        // numbers are finite, see `Heightfield::new`.
        unsafe {
            dGeomHeightfieldDataBuildDouble(
                id,
                field.heights().as_ptr(),
                0,
                length_for_ode(width, columns),
                length_for_ode(depth, rows),
                columns as i32,
                rows as i32,
                1.0,
                0.0,
                field.thickness(),
                field.wraps().into(),
            );
        }
        Ok(data)
    }

    /// ODE's id of the data.
    pub(super) fn id(&self) -> dHeightfieldDataID {
        self.0
    }
}

impl Drop for HeightData {
    fn drop(&mut self) {
        // SAFETY: dGeomHeightfieldDataCreate made it, and its owner destroys the geom that uses it first.
        unsafe { dGeomHeightfieldDataDestroy(self.0) };
    }
}

/// The width or depth for ODE: `length`, or a few units in the last place less.
///
/// ODE divides a coordinate by the spacing to find its cell. For one length in eight, roundoff puts a geom that touches
/// the border into the cell beyond it, and ODE aborts.
fn length_for_ode(length: f64, count: usize) -> f64 {
    let cells = (count - 1) as f64;
    let mut nearest = length;
    // The computation of ODE, operation by operation.
    while (nearest * (1.0 / (nearest / cells))).next_down().floor() >= cells {
        nearest = nearest.next_down();
    }
    nearest
}

/// Refuses a pair of a heightfield and a geom over too many of its cells.
///
/// # Errors
///
/// [`Error::Argument`] with both geoms and the number of cells.
pub(super) fn check_pair(world: &World, geoms: [GeomId; 2]) -> Result<()> {
    let [first, second] = geoms;
    check_cells(world, first, second)?;
    check_cells(world, second, first)
}

/// Refuses `other` if `ground` is a heightfield and `other` is over too many of its cells.
fn check_cells(world: &World, ground: GeomId, other: GeomId) -> Result<()> {
    let (ground, other) = (world.geom(ground), world.geom(other));
    let Some(Shape::Heightfield(field)) = ground.shape() else { return Ok(()) };
    // SAFETY: the view borrows the world, so the geom is alive.
    if !unsafe { collides_with_heightfields(other.raw()) } {
        return Ok(());
    }

    let local = other.aabb().transformed(&ground.pose().inverse());
    let cells = cells_along(field, 0, local.min.x, local.max.x)
        .and_then(|x| Ok(x * cells_along(field, 1, local.min.z, local.max.z)?));
    match cells {
        Ok(cells) if cells <= MOST_CELLS => Ok(()),
        Ok(cells) | Err(cells) => Err(Error::argument(format!(
            "{:?} over the heightfield {:?}: expected at most {MOST_CELLS} cells of the grid under a geom, found \
             {cells}; use a coarser grid, a smaller geom or a shorter ray",
            other.id(),
            ground.id()
        ))),
    }
}

/// The number of cells between two coordinates along x (axis 0) or z (axis 1), at least as many as ODE visits. A cell
/// number that ODE could not hold is an error.
fn cells_along(field: &Heightfield, axis: usize, low: f64, high: f64) -> std::result::Result<f64, f64> {
    let (size, count) = (field.size()[axis], (field.counts()[axis] - 1) as f64);
    let cell = |coordinate: f64| (coordinate + 0.5 * size) / size * count;
    let (mut first, mut end) = (cell(low).floor() - 1.0, cell(high).ceil() + 1.0);
    let is_beside = !field.wraps() && (end < 0.0 || first > count);
    if is_beside {
        return Ok(0.0);
    }
    if first < -LARGEST_CELL || end > LARGEST_CELL {
        return Err(end - first);
    }

    if !field.wraps() {
        (first, end) = (first.max(0.0), end.min(count));
    }
    Ok(end - first)
}

/// Whether ODE has a collider for heightfields and the class of `geom`.
///
/// # Safety
///
/// `geom` is alive.
unsafe fn collides_with_heightfields(geom: dGeomID) -> bool {
    // SAFETY: the caller guarantees a living geom.
    let class = unsafe { dGeomGetClass(geom) } as u32;
    [dSphereClass, dBoxClass, dCapsuleClass, dCylinderClass, dConvexClass, dTriMeshClass, dRayClass]
        .contains(&class)
}

/// Drops contacts of a heightfield that are none: hits of a ray that are not on it, or beyond the border of the field.
///
/// ODE reports a ray that is below all heights near it, and on level ground it intersects the ray with the whole plane.
///
/// # Safety
///
/// Both geoms are alive; `raw` and `geoms` are the same pair.
pub(super) unsafe fn drop_false_contacts(
    world: &World,
    raw: [dGeomID; 2],
    geoms: [GeomId; 2],
    contacts: &mut Contacts<'_>,
) {
    // SAFETY: the caller guarantees living geoms.
    let classes = raw.map(|geom| unsafe { dGeomGetClass(geom) } as u32);
    let ray = match classes {
        [first, second] if first == dRayClass && second == dHeightfieldClass => 0,
        [first, second] if first == dHeightfieldClass && second == dRayClass => 1,
        _ => return,
    };

    let (mut origin, mut direction) = ([0.0; 4], [0.0; 4]);
    // SAFETY: the geom is alive and a ray; both arrays hold four numbers.
    unsafe { dGeomRayGet(raw[ray], origin.as_mut_ptr(), direction.as_mut_ptr()) };
    let (origin, direction) = (convert::point(&origin), convert::vector(&direction));

    let ground = world.geom(geoms[1 - ray]);
    contacts.retain(|contact| {
        let roundoff = ROUNDOFF * (1.0 + origin.coords.norm() + contact.depth.abs());
        is_on_ray(contact, &origin, &direction, roundoff)
            && match ground.shape() {
                Some(Shape::Heightfield(field)) => {
                    is_within(field, &ground.pose().inverse_transform_point(&contact.position), roundoff)
                }
                _ => true,
            }
    });
}

/// Whether a contact is at its depth along a ray.
fn is_on_ray(contact: &ContactGeom, origin: &Point3<f64>, direction: &Vector3<f64>, roundoff: f64) -> bool {
    (origin + contact.depth * direction - contact.position).norm() <= roundoff
}

/// Whether a point in the field's frame is above or below the field.
fn is_within(field: &Heightfield, point: &Point3<f64>, roundoff: f64) -> bool {
    let [width, depth] = field.size();
    field.wraps() || (point.x.abs() <= 0.5 * width + roundoff && point.z.abs() <= 0.5 * depth + roundoff)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_every_width_the_border_is_in_the_last_cell() {
        let mut changed = 0;
        for count in 2..500 {
            for tenths in 1..200 {
                let (length, cells) = (f64::from(tenths) * 0.1, (count - 1) as f64);
                let used = length_for_ode(length, count);
                let inverse = 1.0 / (used / cells);
                assert!((used * inverse).next_down().floor() < cells, "{length} m, {count} samples");
                assert!((length - used).abs() <= 1e-14 * length, "{length} m became {used} m");
                changed += usize::from(used != length);
            }
        }
        assert!(changed > 0, "expected lengths that ODE could not use");
    }

    #[test]
    fn cells_are_counted_within_the_border_and_without_one() {
        let field = Heightfield::new(vec![0.0; 15], [5, 3], [4.0, 1.0]).unwrap();
        assert_eq!(cells_along(&field, 0, -100.0, 100.0), Ok(4.0));
        assert_eq!(cells_along(&field, 1, -100.0, 100.0), Ok(2.0));
        assert_eq!(cells_along(&field, 0, 10.0, 1e9), Ok(0.0));
        assert_eq!(cells_along(&field, 0, -1e9, -10.0), Ok(0.0));
        assert!(cells_along(&field, 0, -2e9, 0.0).is_err());

        let endless = field.wrapped();
        assert_eq!(cells_along(&endless, 0, -100.0, 100.0), Ok(202.0));
        assert!(cells_along(&endless, 0, 2e9, 2e9 + 1.0).is_err());
    }
}
