//! The exported C functions, in the order of `include/ode_visual_hull.h`, which documents them.
//!
//! Each function runs in `fenced`: an error, or a panic in this library, becomes the thread's message and the
//! function's failure value. Ids of data objects and of hulls are looked up in tables and never dereferenced. The
//! caller guarantees that arrays, other geoms and spaces are valid, as for all of ODE.

#![allow(unsafe_code)]

mod arguments;
mod data;
mod fence;
#[cfg(test)]
mod tests;

pub use data::DataId;

use crate::camera::{Camera, Distortion, Fisheye};
use crate::contact::Mode;
use crate::hull::{Aabb, HullData, Motion, Unseen};
use crate::ode::{self, RawHull};
use crate::rig::Rig;
use crate::sample;
use crate::silhouette::{MaskView, load_mask};
use crate::{Error, Result};
use arguments::{
    CameraArguments, coefficients, finite_point, image_size, index, not_null, numbers, step_size, vectors,
    write_vector,
};
use fence::{fenced, utf8};
use nalgebra::{Matrix3x4, Point3};
use ode_sys::{dContact, dGeomID, dReal, dSpaceID};
use std::ffi::{c_char, c_int, c_uchar};
use std::slice;

/// Success of a function that returns an `int`.
const OK: c_int = 1;
/// Failure of a function that returns an `int`.
const FAILED: c_int = 0;
/// Failure of a function that returns an index, a number or a state from 0.
const NONE: c_int = -1;

#[unsafe(no_mangle)]
extern "C" fn dInitVisualHull() -> c_int {
    fence::keep_quiet();
    fenced(FAILED, || ode::open_class().map(|()| OK))
}

#[unsafe(no_mangle)]
extern "C" fn dCloseVisualHull() {
    fenced((), ode::close_class);
}

#[unsafe(no_mangle)]
extern "C" fn dGetVisualHullClass() -> c_int {
    fenced(NONE, ode::open_class_number)
}

#[unsafe(no_mangle)]
extern "C" fn dVisualHullGetErrorMessage() -> *const c_char {
    fence::message()
}

#[unsafe(no_mangle)]
extern "C" fn dVisualHullGetVersion() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataCreate() -> DataId {
    fenced(std::ptr::null_mut(), || Ok(data::create()))
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataDestroy(d: DataId) {
    fenced((), || data::destroy(d));
}

/// # Safety
/// `P` is NULL or twelve numbers.
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's name")]
unsafe extern "C" fn dGeomVisualHullDataAddView(
    d: DataId,
    P: *const dReal,
    width: c_int,
    height: c_int,
) -> c_int {
    fenced(NONE, || {
        let data = data::get(d)?;
        // SAFETY: the caller guarantees twelve numbers.
        let p = Matrix3x4::from_row_slice(unsafe { numbers(P, 12, "P") }?);
        let name = format!("view {}", data.view_count());
        let camera = Camera::from_projection(name, image_size(width, height)?, &p)?;
        Ok(data.add_view(camera)? as c_int)
    })
}

/// # Safety
/// `K` and `R` are NULL or nine numbers, `t` NULL or three, `distortion` NULL or `nDistortion`.
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's names")]
#[allow(clippy::too_many_arguments, reason = "the header's arguments")]
unsafe extern "C" fn dGeomVisualHullDataAddCamera(
    d: DataId,
    K: *const dReal,
    R: *const dReal,
    t: *const dReal,
    distortion: *const dReal,
    nDistortion: c_int,
    width: c_int,
    height: c_int,
) -> c_int {
    fenced(NONE, || {
        let data = data::get(d)?;
        let count = arguments::count(nDistortion, 14, "nDistortion")?;
        // SAFETY: the caller guarantees arrays of these lengths.
        let (camera, distortion) = unsafe {
            (CameraArguments::read(K, R, t, width, height)?, coefficients(distortion, count, "distortion")?)
        };
        Ok(data.add_view(camera.with_lens(&data, Distortion::from_opencv(distortion)?)?)? as c_int)
    })
}

/// # Safety
/// `K` and `R` are NULL or nine numbers, `t` NULL or three, `k` NULL or `nk`.
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's names")]
#[allow(clippy::too_many_arguments, reason = "the header's arguments")]
unsafe extern "C" fn dGeomVisualHullDataAddFisheyeCamera(
    d: DataId,
    K: *const dReal,
    R: *const dReal,
    t: *const dReal,
    k: *const dReal,
    nk: c_int,
    width: c_int,
    height: c_int,
) -> c_int {
    fenced(NONE, || {
        let data = data::get(d)?;
        let count = arguments::count(nk, 4, "nk")?;
        // SAFETY: the caller guarantees arrays of these lengths.
        let (camera, k) =
            unsafe { (CameraArguments::read(K, R, t, width, height)?, coefficients(k, count, "k")?) };
        Ok(data.add_view(camera.with_lens(&data, Fisheye::from_opencv(k)?)?)? as c_int)
    })
}

/// # Safety
/// `path` is NULL or a C string.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullDataLoadRig(d: DataId, path: *const c_char) -> c_int {
    fenced(FAILED, || {
        let data = data::get(d)?;
        // SAFETY: the caller guarantees a C string.
        let rig = Rig::load(unsafe { utf8(path, "path") }?)?;
        data.add_views(rig.cameras())?;
        Ok(rig.len() as c_int)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataGetViewCount(d: DataId) -> c_int {
    fenced(NONE, || Ok(data::get(d)?.view_count() as c_int))
}

/// # Safety
/// `aabb` is NULL or six numbers.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullDataSetBounds(d: DataId, aabb: *const dReal) -> c_int {
    fenced(FAILED, || {
        let data = data::get(d)?;
        // SAFETY: the caller guarantees six numbers.
        let b = unsafe { numbers(aabb, 6, "aabb") }?;
        data.set_bounds(Aabb::new(Point3::new(b[0], b[2], b[4]), Point3::new(b[1], b[3], b[5]))?)?;
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's names")]
extern "C" fn dGeomVisualHullDataSetUnseen(d: DataId, policy: c_int, minViews: c_int) -> c_int {
    fenced(FAILED, || {
        let unseen = match policy {
            0 => Unseen::Outside,
            1 => Unseen::Abstain { min_views: arguments::count(minViews, c_int::MAX, "minViews")? },
            _ => {
                return Err(Error::argument(format!(
                    "policy: expected dVisualHullUnseen..., found {policy}"
                )));
            }
        };
        data::get(d)?.set_unseen(unseen)?;
        Ok(OK)
    })
}

/// # Safety
/// `mask` is NULL, or points to as many rows as the view's image has, `rowStride` bytes apart. The last row may end
/// after the image's width.
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's names")]
unsafe extern "C" fn dGeomVisualHullDataSetMask(
    d: DataId,
    view: c_int,
    mask: *const c_uchar,
    rowStride: c_int,
) -> c_int {
    // SAFETY: the caller guarantees the rows.
    unsafe { set_mask(d, view, mask, rowStride, |data, view, mask| data.set_mask(view, mask)) }
}

/// # Safety
/// The rules of [`dGeomVisualHullDataSetMask`] apply.
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's names")]
unsafe extern "C" fn dGeomVisualHullDataSetMaskAt(
    d: DataId,
    view: c_int,
    mask: *const c_uchar,
    rowStride: c_int,
    time: dReal,
) -> c_int {
    // SAFETY: the caller guarantees the rows.
    unsafe { set_mask(d, view, mask, rowStride, |data, view, mask| data.set_mask_at(view, mask, time)) }
}

/// Passes the caller's mask to `set` without copying it.
///
/// # Safety
/// The rules of [`dGeomVisualHullDataSetMask`] apply.
#[allow(non_snake_case, reason = "the header's names")]
unsafe fn set_mask(
    d: DataId,
    view: c_int,
    mask: *const c_uchar,
    rowStride: c_int,
    set: impl FnOnce(&HullData, usize, MaskView) -> Result<()>,
) -> c_int {
    fenced(FAILED, || {
        let (data, view) = (data::get(d)?, index(view)?);
        let size = data.camera(view)?.size();

        if mask.is_null() {
            return Err(Error::argument("mask: expected the first byte of the top row, found NULL"));
        }
        let (width, height) = (size.0 as usize, size.1 as usize);
        let stride = usize::try_from(rowStride).ok().filter(|&stride| stride >= width).ok_or_else(|| {
            let problem =
                format!("rowStride: expected at least the width of {width} pixels, found {rowStride}");
            Error::argument(problem)
        })?;

        // SAFETY: the caller guarantees all rows, and does not write to them during the call.
        let bytes = unsafe { slice::from_raw_parts(mask, (height - 1) * stride + width) };
        set(&data, view, MaskView::new(bytes, size, stride)?)?;
        Ok(OK)
    })
}

/// # Safety
/// `path` is NULL or a C string.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullDataLoadMask(d: DataId, view: c_int, path: *const c_char) -> c_int {
    fenced(FAILED, || {
        let (data, view) = (data::get(d)?, index(view)?);
        // SAFETY: the caller guarantees a C string.
        data.set_mask(view, &load_mask(unsafe { utf8(path, "path") }?)?)?;
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataSetViewEnabled(d: DataId, view: c_int, enabled: c_int) -> c_int {
    fenced(FAILED, || data::get(d)?.set_view_enabled(index(view)?, enabled != 0).map(|()| OK))
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataSetMaxAge(d: DataId, seconds: dReal) -> c_int {
    fenced(FAILED, || {
        let max_age = (seconds != 0.0).then_some(seconds);
        data::get(d)?.set_max_age(max_age).map(|()| OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataUpdate(d: DataId, time: dReal) -> c_int {
    fenced(FAILED, || {
        let data = data::get(d)?;
        data.update(time)?;
        // SAFETY: the header requires a call between two collides, on the thread that runs the simulation.
        unsafe { ode::apply_latest_frame_everywhere(&data) };
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataPublish(d: DataId, time: dReal) -> c_int {
    fenced(FAILED, || data::get(d)?.update(time).map(|_| OK))
}

/// # Safety
/// `space` is NULL or a living space that is not being collided.
#[unsafe(no_mangle)]
unsafe extern "C" fn dCreateVisualHull(space: dSpaceID, d: DataId) -> dGeomID {
    fenced(std::ptr::null_mut(), || {
        let data = data::get(d)?;
        // SAFETY: the caller guarantees a living space or NULL.
        unsafe { ode::create_hull_in(space, data) }
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullUpdate(g: dGeomID) -> c_int {
    fenced(FAILED, || {
        let hull = RawHull::find(g)?;
        // SAFETY: the header requires a call between two collides, on the thread that steps the geom's world.
        unsafe { hull.apply_latest_frame() };
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetData(g: dGeomID, d: DataId) {
    fenced((), || {
        let (hull, data) = (RawHull::find(g)?, data::get(d)?);
        hull.set_data(data.clone());
        // SAFETY: the header requires a call between two collides.
        unsafe { ode::apply_latest_frame_everywhere(&data) };
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullGetData(g: dGeomID) -> DataId {
    fenced(std::ptr::null_mut(), || Ok(data::id_of(&RawHull::find(g)?.data())))
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMotion(g: dGeomID, mode: c_int) {
    fenced((), || {
        let motion = match mode {
            0 => Motion::Held,
            1 => Motion::Interpolated,
            2 => Motion::Predicted,
            _ => return Err(Error::argument(format!("mode: expected dVisualHullMotion..., found {mode}"))),
        };
        RawHull::find(g)?.set_motion(motion);
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetTime(g: dGeomID, time: dReal) -> c_int {
    fenced(FAILED, || {
        let hull = RawHull::find(g)?;
        // SAFETY: the header requires a call between two collides, on the thread that steps the geom's world.
        unsafe { hull.set_time(time) }?;
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullPointInside(g: dGeomID, x: dReal, y: dReal, z: dReal) -> c_int {
    fenced(NONE, || Ok(c_int::from(RawHull::find(g)?.inside(&Point3::new(x, y, z)))))
}

/// # Safety
/// `w` is NULL or points to writable memory for three numbers.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullPointResponse(
    g: dGeomID,
    x: dReal,
    y: dReal,
    z: dReal,
    w: *mut dReal,
) -> c_int {
    fenced(NONE, || {
        let response = RawHull::find(g)?.point_response(&Point3::new(x, y, z));
        // SAFETY: the caller guarantees memory for the vector.
        unsafe { write_vector(response.unwrap_or_default(), w, "w") }?;
        Ok(c_int::from(response.is_some()))
    })
}

/// # Safety
/// `v` is NULL or points to writable memory for three numbers.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullPointVelocity(
    g: dGeomID,
    x: dReal,
    y: dReal,
    z: dReal,
    v: *mut dReal,
) -> c_int {
    fenced(NONE, || {
        let velocity = RawHull::find(g)?.point_velocity(&finite_point(x, y, z)?);
        // SAFETY: the caller guarantees memory for the vector.
        unsafe { write_vector(velocity.unwrap_or_default(), v, "v") }?;
        Ok(c_int::from(velocity.is_some()))
    })
}

/// # Safety
/// `body` is NULL or a living geom, and `v` is NULL or points to writable memory for three numbers.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullBodyResponse(g: dGeomID, body: dGeomID, v: *mut dReal) -> c_int {
    fenced(NONE, || {
        let hull = RawHull::find(g)?;
        not_null(body, "body")?;
        // SAFETY: the caller guarantees a living geom and memory for the vector.
        unsafe {
            let response = hull.body_response(body)?;
            write_vector(response.vector, v, "v")?;
            Ok(response.colliding as c_int)
        }
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetContactMode(g: dGeomID, mode: c_int) {
    fenced((), || {
        let mode = match mode {
            0 => Mode::Clustered,
            1 => Mode::Paper,
            2 => Mode::Point,
            3 => Mode::Single,
            _ => return Err(Error::argument(format!("mode: expected dVisualHullContacts..., found {mode}"))),
        };
        RawHull::find(g)?.set_mode(mode);
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMaxContacts(g: dGeomID, n: c_int) {
    fenced((), || RawHull::find(g)?.set_max_contacts(arguments::count(n, c_int::MAX, "n")?));
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMaxDepth(g: dGeomID, depth: dReal) {
    fenced((), || RawHull::find(g)?.set_max_depth(depth));
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetMinFeature(g: dGeomID, diameter: dReal) {
    fenced((), || RawHull::find(g)?.set_min_feature(diameter));
}

/// # Safety
/// `contact` is NULL or points to a contact, whose geoms are NULL or living.
#[unsafe(no_mangle)]
unsafe extern "C" fn dVisualHullSetContactMotion(contact: *mut dContact, stepsize: dReal) -> c_int {
    fenced(NONE, || {
        let stepsize = step_size(stepsize)?;
        // SAFETY: the caller guarantees a contact and its geoms; the body of a living geom is living.
        unsafe {
            let contact = arguments::contact(contact)?;
            Ok(c_int::from(ode::set_contact_motion(contact, stepsize)))
        }
    })
}

/// # Safety
/// `body` is NULL or a living geom; `points`, and `normals` where it is not NULL, are `count` vectors of three
/// numbers, `stride` bytes apart.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullSetSamples(
    body: dGeomID,
    points: *const dReal,
    normals: *const dReal,
    count: c_int,
    stride: c_int,
) -> c_int {
    fenced(FAILED, || {
        not_null(body, "body")?;
        let count = arguments::count(count, sample::MAX_SAMPLES as c_int, "count")?;

        // SAFETY: the caller guarantees the arrays and a living geom.
        unsafe {
            let points: Vec<Point3<f64>> =
                vectors(points, count, stride, "points")?.into_iter().map(Point3::from).collect();
            // Without normals every sample can carry a contact, whatever its direction.
            let normals =
                if normals.is_null() { None } else { Some(vectors(normals, count, stride, "normals")?) };
            ode::set_samples(body, sample::from_points(&points, normals.as_deref())?);
        }
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullClearSamples(body: dGeomID) {
    fenced((), || {
        ode::clear_samples(body);
        Ok(())
    });
}
