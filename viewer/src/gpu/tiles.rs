//! The tiles of a target, in which no ray comes near the hull, or rays start at the same depth.

use super::device::Device;
use super::layouts::{Layouts, bind};
use super::target::{DEPTH, clear_depths, texture};

/// Pixels along a side of a tile.
pub const TILE: u32 = 8;

/// The tiles of a target of one size.
#[derive(Debug)]
pub struct Tiles {
    view: wgpu::TextureView,
    /// Group 3 of the passes that draw the target.
    pub group: wgpu::BindGroup,
}

impl Tiles {
    /// The tiles of a target of `size`.
    pub fn new(device: &Device, layouts: &Layouts, size: (u32, u32)) -> Self {
        use wgpu::TextureUsages as Usages;
        let size = (size.0.div_ceil(TILE), size.1.div_ceil(TILE));
        let usage = Usages::RENDER_ATTACHMENT | Usages::TEXTURE_BINDING;
        let view = texture(device, "tiles", size, DEPTH, usage).create_view(&Default::default());
        let group = bind(device, &layouts.depths, vec![wgpu::BindingResource::TextureView(&view)]);
        Self { view, group }
    }

    /// A pass that draws the tiles.
    pub fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tiles"),
            color_attachments: &[Some(clear_depths(&self.view))],
            ..Default::default()
        })
    }
}
