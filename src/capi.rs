//! The exported functions, in the order of `include/ode_visual_hull.h`, which documents them.
//!
//! Each is fenced: an error, or a panic of ours, becomes the thread's message and the function's failure value. Ids of
//! data objects and of hulls are looked up, not followed; arrays, other geoms and spaces are the caller's to vouch
//! for, as with all of ODE.

#![allow(unsafe_code)]

mod data;
mod fence;
#[cfg(test)]
mod tests;

pub use data::DataId;

use crate::camera::{Camera, Distortion, Fisheye, Lens};
use crate::contact::Mode;
use crate::hull::{Aabb, HullData, Unseen};
use crate::ode::{self, RawHull};
use crate::rig::Rig;
use crate::sample;
use crate::silhouette::{MaskView, load_mask};
use crate::{Error, Result};
use fence::{fenced, utf8};
use nalgebra::{Isometry3, Matrix3, Matrix3x4, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use ode_sys::{dGeomID, dReal, dSpaceID};
use std::ffi::{c_char, c_int, c_uchar};
use std::slice;

/// What functions that return an `int` of success say.
const OK: c_int = 1;
const FAILED: c_int = 0;
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
        // SAFETY: the caller vouches for twelve numbers.
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
        let count = count(nDistortion, 14, "nDistortion")?;
        // SAFETY: the caller vouches for the arrays.
        let (camera, lens) =
            unsafe { (Parts::new(K, R, t, width, height)?, coefficients(distortion, count, "distortion")?) };
        Ok(data.add_view(camera.with_lens(&data, Distortion::from_opencv(lens)?)?)? as c_int)
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
        let count = count(nk, 4, "nk")?;
        // SAFETY: the caller vouches for the arrays.
        let (camera, lens) = unsafe { (Parts::new(K, R, t, width, height)?, coefficients(k, count, "k")?) };
        Ok(data.add_view(camera.with_lens(&data, Fisheye::from_opencv(lens)?)?)? as c_int)
    })
}

/// # Safety
/// `path` is NULL or a C string.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullDataLoadRig(d: DataId, path: *const c_char) -> c_int {
    fenced(FAILED, || {
        let data = data::get(d)?;
        // SAFETY: the caller vouches for a C string.
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
        // SAFETY: the caller vouches for six numbers.
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
            1 => Unseen::Abstain { min_views: count(minViews, c_int::MAX, "minViews")? },
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
/// `mask` is NULL or as many rows of `rowStride` bytes as the view's image has, the last one of its width.
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's names")]
unsafe extern "C" fn dGeomVisualHullDataSetMask(
    d: DataId,
    view: c_int,
    mask: *const c_uchar,
    rowStride: c_int,
) -> c_int {
    // SAFETY: the caller vouches for the rows.
    unsafe { set_mask(d, view, mask, rowStride, |data, view, mask| data.set_mask(view, mask)) }
}

/// # Safety
/// As [`dGeomVisualHullDataSetMask`].
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the header's names")]
unsafe extern "C" fn dGeomVisualHullDataSetMaskAt(
    d: DataId,
    view: c_int,
    mask: *const c_uchar,
    rowStride: c_int,
    time: dReal,
) -> c_int {
    // SAFETY: the caller vouches for the rows.
    unsafe { set_mask(d, view, mask, rowStride, |data, view, mask| data.set_mask_at(view, mask, time)) }
}

/// Borrows a mask from its caller, and hands it to `set`.
///
/// # Safety
/// As [`dGeomVisualHullDataSetMask`].
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
            return Err(Error::argument("mask: expected the first byte of the upper row, found NULL"));
        }
        let (width, height) = (size.0 as usize, size.1 as usize);
        let stride = usize::try_from(rowStride).ok().filter(|&stride| stride >= width).ok_or_else(|| {
            let problem =
                format!("rowStride: expected at least the width of {width} pixels, found {rowStride}");
            Error::argument(problem)
        })?;
        // SAFETY: the caller vouches for all rows, and leaves them alone during the call.
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
        // SAFETY: the caller vouches for a C string.
        data.set_mask(view, &load_mask(unsafe { utf8(path, "path") }?)?)?;
        Ok(OK)
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataSetViewEnabled(d: DataId, view: c_int, enabled: c_int) -> c_int {
    fenced(FAILED, || data::get(d)?.set_view_enabled(index(view)?, enabled != 0).map(|()| OK))
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullDataUpdate(d: DataId, time: dReal) -> c_int {
    fenced(FAILED, || {
        let data = data::get(d)?;
        data.update(time)?;
        // SAFETY: the header has it called between two collides, where the simulation runs.
        unsafe { ode::apply_latest_frame_everywhere(&data) };
        Ok(OK)
    })
}

/// # Safety
/// `space` is NULL or a living space that is not being collided.
#[unsafe(no_mangle)]
unsafe extern "C" fn dCreateVisualHull(space: dSpaceID, d: DataId) -> dGeomID {
    fenced(std::ptr::null_mut(), || {
        let data = data::get(d)?;
        // SAFETY: the caller vouches for the space.
        unsafe { ode::create_hull_in(space, data) }
    })
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullSetData(g: dGeomID, d: DataId) {
    fenced((), || {
        let (hull, data) = (RawHull::find(g)?, data::get(d)?);
        hull.set_data(data.clone());
        // SAFETY: the header has it called between two collides.
        unsafe { ode::apply_latest_frame_everywhere(&data) };
        Ok(())
    });
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullGetData(g: dGeomID) -> DataId {
    fenced(std::ptr::null_mut(), || Ok(data::id_of(&RawHull::find(g)?.data())))
}

#[unsafe(no_mangle)]
extern "C" fn dGeomVisualHullPointInside(g: dGeomID, x: dReal, y: dReal, z: dReal) -> c_int {
    fenced(NONE, || Ok(c_int::from(RawHull::find(g)?.inside(&Point3::new(x, y, z)))))
}

/// # Safety
/// `w` is NULL or room for a vector.
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
        // SAFETY: the caller vouches for the vector.
        unsafe { give(response.unwrap_or_default(), w, "w") }?;
        Ok(c_int::from(response.is_some()))
    })
}

/// # Safety
/// `body` is NULL or a living geom, `v` NULL or room for a vector.
#[unsafe(no_mangle)]
unsafe extern "C" fn dGeomVisualHullBodyResponse(g: dGeomID, body: dGeomID, v: *mut dReal) -> c_int {
    fenced(NONE, || {
        let hull = RawHull::find(g)?;
        not_null(body, "body")?;
        // SAFETY: the caller vouches for geom and vector.
        unsafe {
            let response = hull.body_response(body)?;
            give(response.vector, v, "v")?;
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
    fenced((), || RawHull::find(g)?.set_max_contacts(count(n, c_int::MAX, "n")?));
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
        let count = self::count(count, sample::MAX_SAMPLES as c_int, "count")?;
        // SAFETY: the caller vouches for the arrays and the geom.
        unsafe {
            let points: Vec<Point3<f64>> =
                vectors(points, count, stride, "points")?.into_iter().map(Point3::from).collect();
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

fn not_null(geom: dGeomID, what: &str) -> Result<()> {
    if geom.is_null() { Err(Error::argument(format!("{what}: expected a geom, found NULL"))) } else { Ok(()) }
}

fn index(view: c_int) -> Result<usize> {
    usize::try_from(view)
        .map_err(|_| Error::argument(format!("view: expected an index from 0, found {view}")))
}

fn count(n: c_int, most: c_int, what: &str) -> Result<usize> {
    if (0..=most).contains(&n) {
        Ok(n as usize)
    } else {
        Err(Error::argument(format!("{what}: expected 0 to {most}, found {n}")))
    }
}

/// A camera but for its lens.
struct Parts {
    k: Matrix3<f64>,
    pose: Isometry3<f64>,
    size: (u32, u32),
}

impl Parts {
    /// # Safety
    /// `k` and `r` are NULL or nine numbers, `t` is NULL or three.
    unsafe fn new(
        k: *const dReal,
        r: *const dReal,
        t: *const dReal,
        width: c_int,
        height: c_int,
    ) -> Result<Self> {
        // SAFETY: the caller vouches for the arrays.
        let (k, r, t) = unsafe { (numbers(k, 9, "K")?, numbers(r, 9, "R")?, numbers(t, 3, "t")?) };
        let pose = Isometry3::from_parts(Translation3::new(t[0], t[1], t[2]), rotation(r)?);
        Ok(Self { k: Matrix3::from_row_slice(k), pose, size: image_size(width, height)? })
    }

    /// The camera, named as the next view of `data`.
    fn with_lens(self, data: &HullData, lens: impl Into<Lens>) -> Result<Camera> {
        Camera::new(format!("view {}", data.view_count()), self.size, self.k, lens, self.pose)
    }
}

/// # Safety
/// `from` is NULL or `n` numbers, which outlive the result. Where there are none it may be NULL.
unsafe fn coefficients<'a>(from: *const dReal, n: usize, what: &str) -> Result<&'a [dReal]> {
    // SAFETY: the caller vouches for them.
    if n == 0 { Ok(&[]) } else { unsafe { numbers(from, n, what) } }
}

fn image_size(width: c_int, height: c_int) -> Result<(u32, u32)> {
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width), Ok(height)) => Ok((width, height)),
        _ => Err(Error::argument(format!(
            "expected an image size of 1 pixel or more, found {width} x {height}"
        ))),
    }
}

/// # Safety
/// `from` is NULL or `n` numbers, which outlive the result.
unsafe fn numbers<'a>(from: *const dReal, n: usize, what: &str) -> Result<&'a [dReal]> {
    if from.is_null() {
        return Err(Error::argument(format!("{what}: expected {n} numbers, found NULL")));
    }
    // SAFETY: the caller vouches for them.
    Ok(unsafe { slice::from_raw_parts(from, n) })
}

/// # Safety
/// `from` is NULL or `n` vectors of three numbers, `stride` bytes apart.
unsafe fn vectors(from: *const dReal, n: usize, stride: c_int, what: &str) -> Result<Vec<Vector3<f64>>> {
    const LEAST: c_int = 3 * size_of::<dReal>() as c_int;
    if from.is_null() || stride < LEAST || !(stride as usize).is_multiple_of(align_of::<dReal>()) {
        let found = if from.is_null() { "NULL".to_owned() } else { format!("a stride of {stride} bytes") };
        return Err(Error::argument(format!(
            "{what}: expected vectors of dReal at least {LEAST} bytes apart, found {found}"
        )));
    }
    // SAFETY: the caller vouches for each vector; they are aligned as the first one is.
    let at = |k: usize| unsafe { slice::from_raw_parts(from.byte_add(k * stride as usize), 3) };
    Ok((0..n).map(|k| Vector3::from_row_slice(at(k))).collect())
}

/// # Safety
/// `into` is NULL or room for a vector.
unsafe fn give(vector: Vector3<f64>, into: *mut dReal, what: &str) -> Result<()> {
    if into.is_null() {
        return Err(Error::argument(format!("{what}: expected room for a vector, found NULL")));
    }
    for (k, number) in vector.iter().enumerate() {
        // SAFETY: the caller vouches for the room.
        unsafe { into.add(k).write(*number) };
    }
    Ok(())
}

/// A rotation from its row-major matrix, which must be one within what a calibration file rounds.
fn rotation(rows: &[dReal]) -> Result<UnitQuaternion<f64>> {
    let matrix = Matrix3::from_row_slice(rows);
    let off = matrix * matrix.transpose() - Matrix3::identity();
    // Asked so that NaN is none.
    if !off.iter().all(|x| x.abs() <= 1e-4) || matrix.determinant() < 0.0 {
        return Err(Error::argument(format!(
            "R: expected a rotation matrix of world to camera, row-major, found {rows:?}"
        )));
    }
    Ok(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&matrix)))
}
