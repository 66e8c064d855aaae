//! A world as text, in ODE's Dynamics Interchange Format.

use super::World;
use crate::{Error, Result};
use ode_sys::dWorldExportDIF;
use std::ffi::c_char;
use std::path::Path;
use std::ptr::null_mut;
use std::slice;

impl World {
    /// Writes what ODE holds of this world to a file, as text in ODE's Dynamics Interchange Format (DIF), to be looked
    /// at. A file that is there already is replaced.
    ///
    /// The file holds
    ///
    /// - gravity, the world's ERP and CFM, and its thresholds for sleep, those of speed squared;
    /// - `body[0]`, `body[1]`, .. from the one added last on: pose, velocities, mass, inertia, forces not yet used up;
    /// - in each body its geoms, also from the last on: the type (`"box"`) and, of simple shapes, the sizes, but neither
    ///   vertices nor offsets;
    /// - `joint[0]`, .. with the bodies that they connect, anchors, axes and limits, in ODE's own frames; the contacts of
    ///   the last collide are joints too.
    ///
    /// ODE leaves out spaces and geoms without a body, such as planes, and has no name for the visual hull: a hull on a
    /// body is an entry without a type, other hulls are not in the file. Units as everywhere: metres, kilograms, seconds.
    /// Numbers are rounded to 15 digits, and nothing reads the file back.
    ///
    /// # Errors
    ///
    /// [`Error::File`] if the file cannot be written; on a full disk the file is left incomplete. [`Error::Ode`] if
    /// there is no memory for the text; the file is not touched then.
    pub fn export_dif(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        std::fs::write(path, self.dif()?).map_err(|e| Error::unwritten(path, &e))
    }

    /// The text of the file. ODE checks none of its writes, so it writes to memory, where only memory can run out.
    fn dif(&self) -> Result<Vec<u8>> {
        let (mut text, mut length): (*mut c_char, usize) = (null_mut(), 0);
        // SAFETY: both places outlive the stream, which is closed below.
        let stream = unsafe { libc::open_memstream(&raw mut text, &raw mut length) };
        if stream.is_null() {
            return Err(no_memory());
        }

        // SAFETY: the world is alive and, since it is not `Sync`, on this thread alone: ODE numbers its bodies in a field
        // that each step sets anew. The prefix of all names is a C string. The stream is open, and closed once.
        let complete = unsafe {
            dWorldExportDIF(self.raw, stream, c"".as_ptr());
            let failed = libc::ferror(stream) != 0;
            libc::fclose(stream) == 0 && !failed
        };

        // SAFETY: a stream that was closed without an error left `length` bytes at `text`.
        let copy = complete.then(|| unsafe { slice::from_raw_parts(text.cast::<u8>(), length) }.to_vec());
        // SAFETY: the text is the caller's to free, or still null; `copy` does not borrow it.
        unsafe { libc::free(text.cast()) };
        copy.ok_or_else(no_memory)
    }
}

fn no_memory() -> Error {
    Error::Ode("no memory for the text of a world: free some, or remove bodies and joints first".into())
}

#[cfg(test)]
mod tests;
