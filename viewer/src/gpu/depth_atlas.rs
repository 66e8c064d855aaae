//! The depth maps of all views side by side in one texture, so that one render pass draws them.

use super::device::Device;
use super::layouts::Layouts;
use super::target::{DEPTH, MASK, texture};
use super::tiles::{TILE, Tiles};
use crate::cpu::CELL;
use crate::scene::Scene;

/// The depth maps of a scene's views.
#[derive(Debug)]
pub struct DepthAtlas {
    /// Columns and rows of a view's part.
    part: (u32, u32),
    /// Parts in a row.
    parts: u32,
    /// The cells of each view's silhouette within its part: first column and row, and their numbers.
    cells: Vec<[u32; 4]>,
    pub depth_view: wgpu::TextureView,
    pub mask_view: wgpu::TextureView,
    pub tiles: Tiles,
}

impl DepthAtlas {
    /// Textures for the depth maps of `scene`.
    pub fn new(device: &Device, layouts: &Layouts, scene: &Scene) -> Self {
        let (part, parts) = layout(scene);
        let size = Self::size(scene);
        use wgpu::TextureUsages as Usages;
        let depth =
            texture(device, "depth maps", size, DEPTH, Usages::RENDER_ATTACHMENT | Usages::TEXTURE_BINDING);
        let mask = texture(device, "mask of the depth maps", size, MASK, Usages::RENDER_ATTACHMENT);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let (depth_view, mask_view) = (view(&depth), view(&mask));
        let tiles = Tiles::new(device, layouts, size);
        let mut atlas = Self { part, parts, cells: Vec::new(), depth_view, mask_view, tiles };
        atlas.set_scene(scene);
        atlas
    }

    /// Width and height of the textures for `scene`.
    pub fn size(scene: &Scene) -> (u32, u32) {
        let ((columns, rows), parts) = layout(scene);
        (columns * parts, rows * (scene.views.len() as u32).div_ceil(parts))
    }

    /// Whether the textures have the right size for `scene`.
    pub fn fits(&self, scene: &Scene) -> bool {
        (self.part, self.parts) == layout(scene) && self.cells.len() == scene.views.len()
    }

    /// Takes over where the silhouettes of `scene` lie.
    pub fn set_scene(&mut self, scene: &Scene) {
        self.cells.clear();
        for view in &scene.views {
            let rect = view.rect();
            let (width, height) = view.camera().size();
            let cell = |pixel: i32, last: u32| (pixel.max(0) / CELL).min(last as i32 / CELL) as u32;
            let end = |pixel: i32, last: u32| cell(pixel + CELL - 1, last + CELL as u32 - 1);
            let (x, y) = (cell(rect.x0, width), cell(rect.y0, height));
            self.cells.push([x, y, end(rect.x1, width) - x, end(rect.y1, height) - y]);
        }
    }

    /// The place of the part of view `index` in the atlas.
    pub fn origin(&self, index: usize) -> (u32, u32) {
        let index = index as u32;
        (index % self.parts * self.part.0, index / self.parts * self.part.1)
    }

    /// The cells of the silhouette of view `index` in the atlas: first column and row, and their numbers.
    pub fn area(&self, index: usize) -> [u32; 4] {
        let ([x, y, columns, rows], origin) = (self.cells[index], self.origin(index));
        [origin.0 + x, origin.1 + y, columns, rows]
    }

    /// What shaders know of the area of view `index`: least and greatest column and row in the part, and the part's place.
    pub fn rows(&self, index: usize) -> [[f32; 4]; 2] {
        let ([x, y, columns, rows], origin) = (self.cells[index], self.origin(index));
        let last = |first: u32, count: u32| (first + count.max(1) - 1) as f32;
        [[x as f32, y as f32, last(x, columns), last(y, rows)], [origin.0 as f32, origin.1 as f32, 0.0, 0.0]]
    }
}

/// Columns and rows of a view's part, and the number of parts in a row.
fn layout(scene: &Scene) -> ((u32, u32), u32) {
    let sizes = scene.views.iter().map(|view| view.camera().size());
    let (width, height) = sizes.fold((1, 1), |(w, h), size| (w.max(size.0), h.max(size.1)));
    // Whole tiles, so that none belongs to two views.
    let cells = |pixels: u32| pixels.div_ceil(CELL as u32).next_multiple_of(TILE);
    let parts = (1..).find(|side| side * side >= scene.views.len() as u32).unwrap_or(1);
    ((cells(width), cells(height)), parts)
}
