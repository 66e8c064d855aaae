//! Memory for the images of a source, used again once an image is no longer looked at.

use image::RgbImage;
use std::collections::VecDeque;
use std::sync::Arc;

/// Images of which the source keeps hold: more than usually are looked at between a camera and its last user.
const KEPT: usize = 16;

/// The last images of a source. The memory of one that has no other user becomes that of a later one: a large image that is
/// allocated anew costs the system a page fault for every 4 KiB.
#[derive(Debug, Default)]
pub(super) struct ImagePool(VecDeque<Arc<RgbImage>>);

impl ImagePool {
    /// An image of `size` pixels, whose bytes `fill` writes.
    ///
    /// # Errors
    /// All errors of `fill`.
    pub(super) fn image<E>(
        &mut self,
        size: (u32, u32),
        fill: impl FnOnce(&mut [u8]) -> Result<(), E>,
    ) -> Result<Arc<RgbImage>, E> {
        let mut image = self.unused(size).unwrap_or_else(|| RgbImage::new(size.0, size.1));
        fill(&mut image)?;
        let image = Arc::new(image);
        if self.0.len() == KEPT {
            self.0.pop_front();
        }
        self.0.push_back(image.clone());
        Ok(image)
    }

    /// An image of this size that has no other user.
    fn unused(&mut self, size: (u32, u32)) -> Option<RgbImage> {
        let is_unused = |image: &Arc<RgbImage>| image.dimensions() == size && Arc::strong_count(image) == 1;
        let place = self.0.iter().position(is_unused)?;
        Arc::into_inner(self.0.remove(place)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn filled(pool: &mut ImagePool, size: (u32, u32), level: u8) -> Arc<RgbImage> {
        let fill = |bytes: &mut [u8]| {
            bytes.fill(level);
            Ok::<_, Infallible>(())
        };
        pool.image(size, fill).unwrap()
    }

    #[test]
    fn an_image_that_is_looked_at_is_never_written_again() {
        let mut pool = ImagePool::default();
        let held: Vec<_> = (0..50).map(|level| filled(&mut pool, (4, 3), level)).collect();
        for (level, image) in held.iter().enumerate() {
            assert!(image.as_raw().iter().all(|byte| usize::from(*byte) == level), "{level}");
        }
    }

    #[test]
    fn the_memory_of_an_unused_image_of_the_same_size_is_used_again() {
        let mut pool = ImagePool::default();
        let place = filled(&mut pool, (4, 3), 1).as_ptr();
        assert_ne!(filled(&mut pool, (3, 4), 2).as_ptr(), place);
        let third = filled(&mut pool, (4, 3), 3);
        assert_eq!((third.as_ptr(), third.as_raw()[0]), (place, 3));
    }
}
