//! A scene on the device: the colours and silhouettes of its views as texture arrays, and what shaders know of each view.
//!
//! A view's layer holds its image with a margin of two pixels, as large as the largest view's. Of each image only the rectangle
//! of the subject is written, and positions are clamped to it: what lies beyond are rests of earlier frames.

use super::depth_atlas::DepthAtlas;
use super::device::Device;
use crate::scene::{Scene, SceneView};
use half::f16;
use half::slice::HalfFloatSliceExt;
use image::RgbImage;
use nalgebra::Matrix3;
use ode_visual_hull::silhouette::Rect;

/// Pixels around each image.
pub const MARGIN: i32 = 2;

/// Pixels around the silhouette whose colours are known: a refined point, 8 cm behind the hull, may lie outside it.
const COLOUR_MARGIN: i32 = 24;

/// A scene on the device.
#[derive(Debug)]
pub struct Upload {
    /// Width, height and number of the layers.
    size: [u32; 3],
    distances: wgpu::Texture,
    photos: wgpu::Texture,
    /// What shaders know of each view.
    pub views: wgpu::Buffer,
    pub distances_view: wgpu::TextureView,
    pub photos_view: wgpu::TextureView,
    /// Memory for what is written, reused.
    bytes: Vec<u8>,
    finite: Vec<f32>,
    halves: Vec<f16>,
}

impl Upload {
    /// Textures for the views of `scene`, still without content.
    pub fn new(device: &Device, scene: &Scene) -> Self {
        let size = size_of(scene);
        let distances = array(device, "distances", size, wgpu::TextureFormat::R16Float);
        let photos = array(device, "photos", size, wgpu::TextureFormat::Rgba8Unorm);
        let view = |texture: &wgpu::Texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            })
        };
        let views = device.raw().create_buffer(&wgpu::BufferDescriptor {
            label: Some("views"),
            size: u64::from(size[2]) * VIEW_ROWS as u64 * 16,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let (distances_view, photos_view) = (view(&distances), view(&photos));
        let (bytes, finite, halves) = (Vec::new(), Vec::new(), Vec::new());
        Self { size, distances, photos, views, distances_view, photos_view, bytes, finite, halves }
    }

    /// Whether the textures have the right size for `scene`.
    pub fn fits(&self, scene: &Scene) -> bool {
        self.size == size_of(scene)
    }

    /// Writes `scene`, whose depth maps will be in `atlas`.
    pub fn write(&mut self, device: &Device, scene: &Scene, atlas: &DepthAtlas) {
        let mut rows = Vec::new();
        for (index, view) in scene.views.iter().enumerate() {
            self.write_distances(device, view, index as u32);
            if let Some(photo) = view.colours() {
                self.write_photo(device, photo, &coloured(view), index as u32);
            }
            rows.extend(self.rows(view, atlas.rows(index)));
        }
        device.queue().write_buffer(&self.views, 0, bytemuck::cast_slice(&rows));
    }

    /// Maps homogeneous image coordinates to those of the textures, from 0 to 1.
    pub fn texture_from_image(&self) -> Matrix3<f64> {
        let [width, height, _] = self.size.map(f64::from);
        let margin = f64::from(MARGIN);
        Matrix3::new(1.0 / width, 0.0, margin / width, 0.0, 1.0 / height, margin / height, 0.0, 0.0, 1.0)
    }

    /// Width and height of a layer in pixels.
    pub fn layer_size(&self) -> [f32; 2] {
        [self.size[0] as f32, self.size[1] as f32]
    }

    fn write_distances(&mut self, device: &Device, view: &SceneView, layer: u32) {
        let (rect, values) = (view.distance().rect(), view.distance().values());
        // An infinite distance would make interpolated ones that are not numbers.
        let most = f16::MAX.to_f32();
        self.finite.clear();
        self.finite.extend(values.iter().map(|distance| distance.clamp(-most, most)));
        self.halves.resize(values.len(), f16::ZERO);
        self.halves.convert_from_f32_slice(&self.finite);
        write(device, &self.distances, &rect, layer, bytemuck::cast_slice(self.halves.reinterpret_cast()));
    }

    fn write_photo(&mut self, device: &Device, photo: &RgbImage, rect: &Rect, layer: u32) {
        self.bytes.clear();
        for y in rect.y0..rect.y1 {
            let first = y as usize * photo.width() as usize;
            let row = &photo.as_raw()[3 * (first + rect.x0 as usize)..3 * (first + rect.x1 as usize)];
            self.bytes.extend(
                row.as_chunks::<3>().0.iter().flat_map(|&[red, green, blue]| [red, green, blue, 255]),
            );
        }
        write(device, &self.photos, rect, layer, &self.bytes);
    }

    /// What shaders know of `view` and of where its depth map lies: `View` in views.wgsl.
    fn rows(&self, view: &SceneView, depth_map: [[f32; 4]; 2]) -> [[f32; 4]; VIEW_ROWS] {
        let image = Rect::of_image(view.camera().size().0, view.camera().size().1);
        let projection = view.projection().cast::<f32>();
        let row = |k: usize| [0, 1, 2, 3].map(|column| projection[(k, column)]);
        let centre = view.centre().cast::<f32>();
        let has_colours = f32::from(u8::from(view.colours().is_some()));
        [
            self.in_texture(&view.rect().grown(1).intersection(&image), 0.0),
            self.in_texture(&image, 0.0),
            self.in_texture(&view.distance().rect(), 0.5),
            self.in_texture(&coloured(view), 0.5),
            depth_map[0],
            depth_map[1],
            row(0),
            row(1),
            row(2),
            [centre.x, centre.y, centre.z, has_colours],
        ]
    }

    /// Least and greatest position in the textures of the part of `rect` that is so many pixels from its border.
    fn in_texture(&self, rect: &Rect, inset: f32) -> [f32; 4] {
        let [width, height, _] = self.size.map(|count| count as f32);
        let at = |pixel: i32, inset: f32| (pixel + MARGIN) as f32 + inset;
        [
            at(rect.x0, inset) / width,
            at(rect.y0, inset) / height,
            at(rect.x1, -inset) / width,
            at(rect.y1, -inset) / height,
        ]
    }
}

/// Rows of four numbers that shaders know of a view.
const VIEW_ROWS: usize = 10;

/// The pixels of the image of `view` that may colour the subject.
fn coloured(view: &SceneView) -> Rect {
    let (width, height) = view.camera().size();
    view.rect().grown(COLOUR_MARGIN).intersection(&Rect::of_image(width, height))
}

/// Width, height and number of the layers for `scene`.
pub fn size_of(scene: &Scene) -> [u32; 3] {
    let sizes = scene.views.iter().map(|view| view.camera().size());
    let (width, height) = sizes.fold((0, 0), |(w, h), size| (w.max(size.0), h.max(size.1)));
    let margin = 2 * MARGIN as u32;
    [width + margin, height + margin, scene.views.len() as u32]
}

fn array(
    device: &Device,
    label: &str,
    [width, height, layers]: [u32; 3],
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    device.raw().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        // OpenGL takes an array of one layer for no array.
        size: wgpu::Extent3d { width, height, depth_or_array_layers: layers.max(2) },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Writes the pixels of `rect` of one layer.
fn write(device: &Device, texture: &wgpu::Texture, rect: &Rect, layer: u32, bytes: &[u8]) {
    if rect.is_empty() {
        return;
    }
    let (width, height) = (rect.width() as u32, rect.height() as u32);
    let origin = wgpu::Origin3d { x: (rect.x0 + MARGIN) as u32, y: (rect.y0 + MARGIN) as u32, z: layer };
    device.queue().write_texture(
        wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() },
        bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes.len() as u32 / height),
            rows_per_image: None,
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}
