//! What pictures are drawn into without a window, and how they are read back.

use super::device::Device;
use super::layouts::{Layouts, bind};
use super::tiles::Tiles;
use crate::picture::{Content, Picture};
use ode_visual_hull::{Error, Result};
use std::sync::mpsc::channel;

/// The colours of a picture, with what a pixel shows as alpha. Not sRGB: colours are blended as the cameras deliver them.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Depths in metres, as the bits of a float: not every device draws into textures of floats.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::R32Uint;

/// Where rays enter the hull: the bits of the depth, and the number of the view that decides.
pub const ENTRY: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// Marks pixels where nothing has to be drawn, for the depth test.
///
/// The test comes before the shader only if that writes no depth: so depths that a picture keeps are colours. Nor may a stencil
/// be written where Mesa's rasteriser shall test first.
pub const MASK: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Larger than any depth: nothing is there. Infinity does not survive every shader compiler.
pub const NOTHING: f32 = 1e30;

/// The alphas of [`Content::Subject`] and [`Content::Body`] in steps of the format.
const SUBJECT: u8 = 128;
const BODY: u8 = 255;

/// The textures of a picture of one size.
#[derive(Debug)]
pub struct Target {
    size: (u32, u32),
    colour: wgpu::Texture,
    depth: wgpu::Texture,
    /// Colours, then depths.
    read_back: wgpu::Buffer,
    pub colour_view: wgpu::TextureView,
    pub depth_view: wgpu::TextureView,
    pub mask_view: wgpu::TextureView,
    pub tiles: Tiles,
    pub entry_view: wgpu::TextureView,
    /// Group 3 of the passes that read where rays enter.
    pub entry_group: wgpu::BindGroup,
}

impl Target {
    /// Textures for pictures of `size`.
    ///
    /// # Errors
    /// A size that the device does not have.
    pub fn new(device: &Device, layouts: &Layouts, size: (u32, u32)) -> Result<Self> {
        let most = device.raw().limits().max_texture_dimension_2d;
        if size.0.min(size.1) == 0 || size.0.max(size.1) > most {
            return Err(Error::argument(format!(
                "picture: expected 1 to {most} pixels along each side for {}, found {} x {}",
                device.name(),
                size.0,
                size.1
            )));
        }

        use wgpu::TextureUsages as Usages;
        let drawn = Usages::RENDER_ATTACHMENT | Usages::COPY_SRC;
        let colour = texture(device, "colour", size, COLOUR, drawn);
        let depth = texture(device, "depth", size, DEPTH, drawn);
        let mask = texture(device, "mask", size, MASK, Usages::RENDER_ATTACHMENT);
        let read_back = device.raw().create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: 2 * u64::from(bytes_per_row(size.0)) * u64::from(size.1),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let (colour_view, depth_view, mask_view) = (view(&colour), view(&depth), view(&mask));
        let tiles = Tiles::new(device, layouts, size);
        let entry =
            texture(device, "entries", size, ENTRY, Usages::RENDER_ATTACHMENT | Usages::TEXTURE_BINDING);
        let entry_view = view(&entry);
        let entry_group =
            bind(device, &layouts.depths, vec![wgpu::BindingResource::TextureView(&entry_view)]);
        Ok(Self {
            size,
            colour,
            depth,
            read_back,
            colour_view,
            depth_view,
            mask_view,
            tiles,
            entry_view,
            entry_group,
        })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Begins to copy the picture to where [`Self::read`] finds it.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        let (width, height) = self.size;
        let row = bytes_per_row(width);
        for (offset, texture) in [(0, &self.colour), (u64::from(row) * u64::from(height), &self.depth)] {
            let layout =
                wgpu::TexelCopyBufferLayout { offset, bytes_per_row: Some(row), rows_per_image: None };
            encoder.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer: &self.read_back, layout },
                texture.size(),
            );
        }
    }

    /// The picture that was copied last, once it is drawn.
    ///
    /// # Errors
    /// A device that has failed.
    pub fn read(&self, device: &Device) -> Result<Picture> {
        let (sender, receiver) = channel();
        self.read_back.map_async(wgpu::MapMode::Read, .., move |outcome| drop(sender.send(outcome)));
        device.wait()?;
        let unread = |found: String| {
            device.failed(format!("expected to read a picture, found: {found}; open the device again"))
        };
        match receiver.recv() {
            Ok(Ok(())) => {}
            Ok(Err(found)) => return Err(unread(found.to_string())),
            Err(found) => return Err(unread(found.to_string())),
        }
        let picture = {
            let bytes = self.read_back.get_mapped_range(..).map_err(|found| unread(found.to_string()))?;
            self.picture(&bytes)
        };
        self.read_back.unmap();
        Ok(picture)
    }

    fn picture(&self, bytes: &[u8]) -> Picture {
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let mut picture = Picture::new(self.size.0, self.size.1);
        let row = bytes_per_row(self.size.0) as usize;
        let (colours, depths) = bytes.split_at(row * height);

        let rows = colours.chunks_exact(row).zip(picture.colour.chunks_exact_mut(3 * width));
        for ((from, colour), content) in rows.zip(picture.content.chunks_exact_mut(width)) {
            let pixels = from.chunks_exact(4).zip(colour.chunks_exact_mut(3)).zip(content);
            for ((from, colour), content) in pixels {
                colour.copy_from_slice(&from[..3]);
                *content = match from[3] {
                    SUBJECT => Content::Subject,
                    BODY => Content::Body,
                    _ => Content::Surroundings,
                };
            }
        }
        for (from, depth) in depths.chunks_exact(row).zip(picture.depth.chunks_exact_mut(width)) {
            for (from, depth) in from.chunks_exact(4).zip(depth) {
                let found = f32::from_le_bytes([from[0], from[1], from[2], from[3]]);
                *depth = if found < NOTHING { found } else { f32::INFINITY };
            }
        }
        picture
    }
}

/// A texture of one layer.
pub fn texture(
    device: &Device,
    label: &str,
    (width, height): (u32, u32),
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.raw().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// Bytes of a row of four-byte pixels in a buffer, which begin where copies may.
fn bytes_per_row(width: u32) -> u32 {
    (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// A texture of depths that are all [`NOTHING`] at first, for one pass.
pub fn clear_depths(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    // A texture of whole numbers is cleared by a whole number.
    let nothing = wgpu::Color { r: f64::from(NOTHING.to_bits()), ..wgpu::Color::TRANSPARENT };
    clear(view, nothing)
}

/// A texture that has one colour at first, for one pass.
pub fn clear(view: &wgpu::TextureView, colour: wgpu::Color) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(colour), store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// A mask that leaves nothing out, for one pass.
pub fn cleared_mask(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
        stencil_ops: None,
    }
}
