//! A scene that is ready to be drawn: on the device, with the depth maps of its views.

use super::depth_atlas::DepthAtlas;
use super::device::Device;
use super::eye::{Eyes, Placement};
use super::layouts::{Layouts, bind};
use super::pipelines::{Pass, Pipelines};
use super::shader::Variant;
use super::target::{clear_depths, cleared_mask};
use super::tiles::TILE;
use super::upload::{Upload, size_of};
use crate::cpu::CELL;
use crate::scene::Scene;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::{Error, Result};

/// More than the bytes that any uniform buffer holds for a view.
const BYTES_PER_VIEW: u64 = 256;

/// A scene on the device. Scenes of as many views of the same sizes use its memory in turn.
#[derive(Debug)]
pub struct Prepared {
    variant: Variant,
    upload: Upload,
    atlas: DepthAtlas,
    eyes: Eyes,
    /// The blocks of the picture's viewpoint and then of each view, at multiples of `stride`.
    blocks: wgpu::Buffer,
    stride: u64,
    /// The views with colours.
    coloured: Vec<usize>,
    scene_group: wgpu::BindGroup,
    eye_group: wgpu::BindGroup,
    pub depth_map_group: wgpu::BindGroup,
}

impl Prepared {
    /// Memory for `scene`.
    ///
    /// # Errors
    /// Views that are too large or too many for the device.
    pub fn new(device: &Device, layouts: &Layouts, scene: &Scene) -> Result<Self> {
        check(device, scene)?;
        let (upload, atlas) = (Upload::new(device, scene), DepthAtlas::new(device, layouts, scene));
        let count = scene.views.len();
        let size = Eyes::block_size(count);
        let stride =
            size.next_multiple_of(u64::from(device.raw().limits().min_uniform_buffer_offset_alignment));
        let blocks = device.raw().create_buffer(&wgpu::BufferDescriptor {
            label: Some("eyes"),
            size: stride * (count as u64 + 1),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let block = wgpu::BufferBinding { buffer: &blocks, offset: 0, size: wgpu::BufferSize::new(size) };
        let scene_group = bind(
            device,
            &layouts.scene,
            vec![
                upload.views.as_entire_binding(),
                wgpu::BindingResource::TextureView(&upload.distances_view),
                wgpu::BindingResource::TextureView(&upload.photos_view),
                wgpu::BindingResource::Sampler(&layouts.bilinear),
            ],
        );
        let eye_group = bind(device, &layouts.eye, vec![wgpu::BindingResource::Buffer(block)]);
        let depth_map_group =
            bind(device, &layouts.depths, vec![wgpu::BindingResource::TextureView(&atlas.depth_view)]);
        let eyes = Eyes::new(scene, &upload);
        let variant = Variant::new(scene, false);
        Ok(Self {
            variant,
            upload,
            atlas,
            eyes,
            blocks,
            stride,
            coloured: Vec::new(),
            scene_group,
            eye_group,
            depth_map_group,
        })
    }

    /// Whether the memory has the right size for `scene`.
    pub fn fits(&self, scene: &Scene) -> bool {
        self.upload.fits(scene) && self.atlas.fits(scene)
    }

    /// The shaders for this scene.
    pub fn variant(&self, refines: bool) -> Variant {
        Variant { refines, ..self.variant }
    }

    /// Writes `scene` and draws the depth maps of its views.
    pub fn set_scene(
        &mut self,
        device: &Device,
        layouts: &Layouts,
        pipelines: &mut Pipelines,
        scene: &Scene,
    ) {
        self.variant = Variant::new(scene, false);
        self.eyes = Eyes::new(scene, &self.upload);
        self.atlas.set_scene(scene);
        self.upload.write(device, scene, &self.atlas);
        for (index, view) in scene.views.iter().enumerate() {
            let (scale, origin) = (CELL as f32, self.atlas.origin(index));
            let shift = [origin.0, origin.1].map(|cells| -scale * cells as f32);
            let block = self.eyes.block(view.camera(), Placement { scale, shift, own: index, planes: 0 });
            self.write_block(device, index + 1, &block);
        }

        let coloured = scene.views.iter().enumerate().filter(|(_, view)| view.colours().is_some());
        self.coloured = coloured.map(|(index, _)| index).collect();
        let passes = [Pass::Tiles, Pass::MaskedCells, Pass::DepthMap];
        self.draw_depth_maps(device, passes.map(|pass| pipelines.get(device, layouts, self.variant, pass)));
    }

    /// Takes over the viewpoint of the next picture.
    pub fn write_eye(&self, device: &Device, camera: &Camera, placement: Placement) {
        self.write_block(device, 0, &self.eyes.block(camera, placement));
    }

    /// The pixels in which `camera` may see the subject: first column and row, and their numbers.
    pub fn area(&self, camera: &Camera) -> [u32; 4] {
        self.eyes.area(camera)
    }

    fn write_block(&self, device: &Device, index: usize, block: &[[f32; 4]]) {
        device.queue().write_buffer(&self.blocks, index as u64 * self.stride, bytemuck::cast_slice(block));
    }

    fn draw_depth_maps(&self, device: &Device, [tiles, mask, depth_map]: [wgpu::RenderPipeline; 3]) {
        let mut encoder = device.raw().create_command_encoder(&Default::default());
        {
            let mut pass = self.atlas.tiles.begin(&mut encoder);
            pass.set_pipeline(&tiles);
            self.draw_views(&mut pass, |[x, y, columns, rows]| {
                let (left, top) = (x / TILE, y / TILE);
                [left, top, (x + columns).div_ceil(TILE) - left, (y + rows).div_ceil(TILE) - top]
            });
        }
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("depth maps"),
                color_attachments: &[Some(clear_depths(&self.atlas.depth_view))],
                depth_stencil_attachment: Some(cleared_mask(&self.atlas.mask_view)),
                ..Default::default()
            });
            pass.set_bind_group(3, &self.atlas.tiles.group, &[]);
            for pipeline in [&mask, &depth_map] {
                pass.set_pipeline(pipeline);
                self.draw_views(&mut pass, |area| area);
            }
        }
        device.queue().submit([encoder.finish()]);
    }

    /// Draws the area of each view that has colours: only these are asked whether they see the subject.
    fn draw_views(&self, pass: &mut wgpu::RenderPass, area: impl Fn([u32; 4]) -> [u32; 4]) {
        for &index in &self.coloured {
            let [x, y, width, height] = area(self.atlas.area(index));
            self.bind(pass, index + 1);
            pass.set_scissor_rect(x, y, width, height);
            pass.draw(0..3, 0..1);
        }
    }

    /// Gives a pass the scene and viewpoint number `eye`: 0 is the picture's, then come the views.
    pub fn bind(&self, pass: &mut wgpu::RenderPass, eye: usize) {
        pass.set_bind_group(0, &self.scene_group, &[]);
        pass.set_bind_group(1, &self.eye_group, &[(eye as u64 * self.stride) as u32]);
    }
}

fn check(device: &Device, scene: &Scene) -> Result<()> {
    let limits = device.raw().limits();
    let blocks = limits.max_uniform_buffer_binding_size / BYTES_PER_VIEW;
    let most_views = u64::from(limits.max_texture_array_layers).min(blocks);
    if scene.views.len() as u64 > most_views {
        return Err(Error::argument(format!(
            "scene: expected at most {most_views} views for {}, found {}; leave views out, or draw without it (--renderer cpu)",
            device.name(),
            scene.views.len()
        )));
    }

    let (most, atlas) = (limits.max_texture_dimension_2d, DepthAtlas::size(scene));
    let [width, height, _] = size_of(scene);
    let sides = [atlas.0, atlas.1, width, height];
    match sides.into_iter().max() {
        Some(side) if side > most => Err(Error::argument(format!(
            "scene: expected images of all views that fit textures of {most} pixels on {}, found that they need {side}; use \
             smaller images or fewer views, or draw without it (--renderer cpu)",
            device.name()
        ))),
        _ => Ok(()),
    }
}
