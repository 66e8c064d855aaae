//! Pictures on a window's surface.

use image::RgbImage;
use ode_visual_hull::{Error, Result};
use softbuffer::{Context, Surface};
use std::num::NonZeroU32;
use std::sync::Arc;
use winit::window::Window;

/// The surface of a window.
pub struct Screen {
    window: Arc<Window>,
    surface: Surface<Arc<Window>, Arc<Window>>,
}

impl Screen {
    /// The surface of `window`.
    ///
    /// # Errors
    /// A display that windows cannot be drawn on.
    pub fn new(window: Arc<Window>) -> Result<Self> {
        let fail = |e: softbuffer::SoftBufferError| {
            Error::argument(format!("window: expected a display to draw on, found: {e}"))
        };
        let context = Context::new(window.clone()).map_err(fail)?;
        let surface = Surface::new(&context, window.clone()).map_err(fail)?;
        Ok(Self { window, surface })
    }

    /// Its window.
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// Shows `picture` in the window's upper left corner; what is beside it is black.
    ///
    /// # Errors
    /// A display that is lost.
    pub fn show(&mut self, picture: &RgbImage) -> Result<()> {
        let size = self.window.inner_size();
        let (Some(width), Some(height)) = (NonZeroU32::new(size.width), NonZeroU32::new(size.height)) else {
            // A window that is minimised shows nothing.
            return Ok(());
        };
        let fail = |e: softbuffer::SoftBufferError| {
            Error::argument(format!("window: expected to show a picture, found: {e}"))
        };
        self.surface.resize(width, height).map_err(fail)?;
        let mut buffer = self.surface.buffer_mut().map_err(fail)?;
        let rows = picture.as_raw().chunks_exact(3 * picture.width().max(1) as usize);
        let mut shown = rows.map(Some).chain(std::iter::repeat(None));
        for row in buffer.chunks_exact_mut(size.width as usize) {
            let colours = shown.next().flatten().unwrap_or_default().chunks_exact(3);
            let packed = colours.map(|c| u32::from(c[0]) << 16 | u32::from(c[1]) << 8 | u32::from(c[2]));
            let mut packed = packed.chain(std::iter::repeat(0));
            row.iter_mut().for_each(|pixel| *pixel = packed.next().unwrap_or_default());
        }
        self.window.pre_present_notify();
        buffer.present().map_err(fail)
    }
}
