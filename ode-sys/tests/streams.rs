//! ODE prints to a `FILE` of libc.

use ode_sys::{
    dCloseODE, dInitODE2, dPrintMatrix, dWorldCreate, dWorldDestroy, dWorldExportDIF, dWorldSetGravity,
};
use std::ptr::null_mut;

/// The text that `print` writes to a stream in memory.
fn printed(print: impl FnOnce(*mut libc::FILE)) -> String {
    let (mut text, mut length): (*mut libc::c_char, usize) = (null_mut(), 0);
    // SAFETY: both places outlive the stream, which is closed before the text is read and freed.
    unsafe {
        let stream = libc::open_memstream(&raw mut text, &raw mut length);
        assert!(!stream.is_null());
        print(stream);
        assert_eq!(libc::fclose(stream), 0);
        let copy = std::slice::from_raw_parts(text.cast::<u8>(), length).to_vec();
        libc::free(text.cast());
        String::from_utf8(copy).unwrap()
    }
}

#[test]
fn an_empty_world_is_exported() {
    // SAFETY: ODE is open while the world, which is made and destroyed here, lives.
    let dif = unsafe {
        assert_ne!(dInitODE2(0), 0);
        let world = dWorldCreate();
        dWorldSetGravity(world, 0.0, 0.0, -9.5);
        let dif = printed(|stream| dWorldExportDIF(world, stream, c"my_".as_ptr()));
        dWorldDestroy(world);
        dCloseODE();
        dif
    };
    assert!(dif.starts_with("-- Dynamics Interchange Format v0.1\n\nmy_world = dynamics.world {\n"), "{dif}");
    assert!(dif.contains("gravity = {0,0,-9.5},") && dif.ends_with("my_body = {}\nmy_joint = {}\n"), "{dif}");
}

#[test]
fn a_matrix_is_printed_row_by_row() {
    // ODE pads rows to a multiple of four.
    let matrix = [1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0, 0.0];
    // SAFETY: two padded rows of three numbers, and a format for one number.
    let text = printed(|stream| unsafe { dPrintMatrix(matrix.as_ptr(), 2, 3, c"%g ".as_ptr(), stream) });
    assert_eq!(text, "1 2 3 \n4 5 6 \n");
}
