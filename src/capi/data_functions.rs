//! The functions on data objects.

use super::arguments::{CameraArguments, coefficients, image_size, index, numbers};
use super::data::{self, DataId};
use super::fence::{fenced, utf8};
use super::{FAILED, NONE, OK, arguments};
use crate::camera::{Camera, Distortion, Fisheye};
use crate::hull::{Aabb, HullData, MaskFilter, Unseen};
use crate::ode;
use crate::rig::Rig;
use crate::silhouette::{MaskView, load_mask};
use crate::{Error, Result};
use nalgebra::{Matrix3x4, Point3};
use ode_sys::dReal;
use std::ffi::{c_char, c_int, c_uchar};
use std::slice;

#[unsafe(no_mangle)]
pub(super) extern "C" fn dGeomVisualHullDataCreate() -> DataId {
    fenced(std::ptr::null_mut(), || Ok(data::create()))
}

#[unsafe(no_mangle)]
pub(super) extern "C" fn dGeomVisualHullDataDestroy(d: DataId) {
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
#[allow(non_snake_case, reason = "the header's names")]
extern "C" fn dGeomVisualHullDataSetMaskFilter(d: DataId, smallestHole: c_int, newWeight: dReal) -> c_int {
    fenced(FAILED, || {
        let smallest_hole_px = arguments::count(smallestHole, c_int::MAX, "smallestHole")? as u32;
        let filter = MaskFilter { smallest_hole_px, new_weight: newWeight };
        data::get(d)?.set_mask_filter(filter).map(|()| OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataSetOverruleDepth(d: DataId, depth: dReal) -> c_int {
    fenced(FAILED, || {
        let depth = (depth != 0.0).then_some(depth);
        data::get(d)?.set_overrule_depth(depth).map(|()| OK)
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
