//! Export of a world as text in ODE's Dynamics Interchange Format.

use super::World;
use crate::{Error, Result};
use ode_sys::dWorldExportDIF;
use std::ffi::c_char;
use std::path::Path;
use std::ptr::null_mut;
use std::slice;

impl World {
    /// Writes ODE's state of this world to a file for inspection, as text in ODE's Dynamics Interchange Format (DIF).
    /// An existing file is replaced.
    ///
    /// The file contains
    ///
    /// - gravity, the world's ERP and CFM, and its sleep thresholds (speeds are squared);
    /// - `body[0]`, `body[1]`, ..., the most recently added first: pose, velocities, mass, inertia and pending forces;
    /// - the geoms of each body, the most recently added first: their type (`"box"`) and the sizes of simple shapes,
    ///   but neither vertices nor offsets;
    /// - `joint[0]`, ..., with the bodies that they connect, and anchors, axes and limits in ODE's own frames. The
    ///   contacts of the last collide are joints too.
    ///
    /// ODE leaves out spaces and geoms without a body, such as planes. It has no name for the visual hull: a hull on a
    /// body is an entry without a type, other hulls are left out. Units are metres, kilograms and seconds. Numbers are
    /// rounded to 15 digits. Nothing reads the file back.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; on a full disk an incomplete file remains. [`Error::Ode`] if
    /// memory runs out, before the file is touched.
    pub fn export_dif(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        std::fs::write(path, self.dif()?).map_err(|e| Error::unwritten(path, &e))
    }

    /// The text of the file.
    ///
    /// ODE does not check whether its writes succeed. So it writes to memory, where only a lack of memory can fail.
    fn dif(&self) -> Result<Vec<u8>> {
        let (mut text, mut length): (*mut c_char, usize) = (null_mut(), 0);
        // SAFETY: both variables outlive the stream, which is closed below.
        let stream = unsafe { libc::open_memstream(&raw mut text, &raw mut length) };
        if stream.is_null() {
            return Err(no_memory());
        }

        // SAFETY: the world is alive. Since it is not `Sync`, no other thread uses it, so ODE may number its bodies in
        // a field that each step overwrites. The prefix of all names is a C string. The stream is open, and closed
        // once.
        let complete = unsafe {
            dWorldExportDIF(self.raw, stream, c"".as_ptr());
            let failed = libc::ferror(stream) != 0;
            libc::fclose(stream) == 0 && !failed
        };

        // SAFETY: a stream that was closed without an error leaves `length` bytes at `text`.
        let copy = complete.then(|| unsafe { slice::from_raw_parts(text.cast::<u8>(), length) }.to_vec());
        // SAFETY: the caller of `open_memstream` frees the text, which may be null; `copy` does not borrow it.
        unsafe { libc::free(text.cast()) };
        copy.ok_or_else(no_memory)
    }
}

fn no_memory() -> Error {
    Error::Ode(
        "memory ran out for the text of a world: free memory, or remove bodies and joints first".into(),
    )
}

#[cfg(test)]
mod tests;
