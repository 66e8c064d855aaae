//! The pipelines of all passes, compiled when they are first needed.

use super::device::Device;
use super::layouts::Layouts;
use super::shader::Variant;
use super::target::{COLOUR, DEPTH, ENTRY, MASK};
use std::collections::HashMap;

/// One kind of pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pass {
    /// Where the rays of tiles start.
    Tiles,
    /// Leaves the cells of a depth map out that lie outside the camera's own silhouette or in empty tiles.
    MaskedCells,
    /// The hull's depths in one camera.
    DepthMap,
    /// Leaves tiles out in which no ray comes near the hull.
    MaskedTiles,
    /// Where rays enter the hull.
    Entry,
    /// Leaves pixels out whose rays miss the hull.
    MaskedPixels,
    /// The subject, coloured by the cameras.
    Blend,
    /// The shape of the hull.
    Hull,
    /// Lets pixels in whose rays enter the hull at the next planes.
    EnteredPixels,
    /// One plane of a sweep.
    Sweep,
    /// A sweep over all planes, pixel by pixel.
    PlainSweep,
    /// The pixels that no plane has covered.
    Rest,
}

/// Pipelines that have been compiled.
#[derive(Debug, Default)]
pub struct Pipelines {
    modules: HashMap<Variant, wgpu::ShaderModule>,
    pipelines: HashMap<(Variant, Pass), wgpu::RenderPipeline>,
}

impl Pipelines {
    /// The pipeline of `pass`.
    pub fn get(
        &mut self,
        device: &Device,
        layouts: &Layouts,
        variant: Variant,
        pass: Pass,
    ) -> wgpu::RenderPipeline {
        let module = self.modules.entry(variant).or_insert_with(|| {
            device.raw().create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("viewer"),
                source: wgpu::ShaderSource::Wgsl(variant.source().into()),
            })
        });
        let pipeline = self.pipelines.entry((variant, pass));
        pipeline.or_insert_with(|| compiled(device, layouts, module, pass)).clone()
    }
}

fn compiled(
    device: &Device,
    layouts: &Layouts,
    module: &wgpu::ShaderModule,
    pass: Pass,
) -> wgpu::RenderPipeline {
    let (vertex, fragment, targets): (_, _, &[wgpu::TextureFormat]) = match pass {
        Pass::Tiles => ("screen", "tile", &[DEPTH]),
        Pass::MaskedCells => ("mask", "masked_cells", &[DEPTH]),
        Pass::DepthMap => ("screen", "depth_map", &[DEPTH]),
        Pass::MaskedTiles => ("mask", "masked_tiles", &[ENTRY]),
        Pass::Entry => ("screen", "hull_entry", &[ENTRY]),
        Pass::MaskedPixels => ("mask", "masked_pixels", &[COLOUR, DEPTH]),
        Pass::Blend => ("screen", "blend", &[COLOUR, DEPTH]),
        Pass::Hull => ("screen", "hull", &[COLOUR, DEPTH]),
        Pass::EnteredPixels => ("band", "entered_pixels", &[COLOUR, DEPTH]),
        Pass::Sweep => ("plane", "sweep", &[COLOUR, DEPTH]),
        Pass::PlainSweep => ("screen", "plain_sweep", &[COLOUR, DEPTH]),
        Pass::Rest => ("behind", "rest", &[COLOUR, DEPTH]),
    };
    // A target cannot be read by the pass that draws it.
    let Layouts { scene, eye, depths, .. } = layouts;
    let groups: &[_] = match pass {
        Pass::Tiles => &[Some(scene), Some(eye)],
        Pass::MaskedCells | Pass::DepthMap | Pass::MaskedTiles | Pass::Entry => {
            &[Some(scene), Some(eye), None, Some(depths)]
        }
        _ => &[Some(scene), Some(eye), Some(depths), Some(depths)],
    };
    let layout = device.raw().create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(fragment),
        bind_group_layouts: groups,
        immediate_size: 0,
    });

    let is_mask =
        matches!(pass, Pass::MaskedTiles | Pass::MaskedCells | Pass::MaskedPixels | Pass::EnteredPixels);
    let write_mask = if is_mask { wgpu::ColorWrites::empty() } else { wgpu::ColorWrites::ALL };
    let target =
        |&format: &wgpu::TextureFormat| Some(wgpu::ColorTargetState { format, blend: None, write_mask });
    let targets: Vec<_> = targets.iter().map(target).collect();
    device.raw().create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: (pass != Pass::Tiles).then(|| wgpu::DepthStencilState {
            format: MASK,
            // A plane that covers a pixel masks it for those behind.
            depth_write_enabled: Some(is_mask || pass == Pass::Sweep),
            depth_compare: Some(if pass == Pass::EnteredPixels {
                wgpu::CompareFunction::Always
            } else {
                wgpu::CompareFunction::Less
            }),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
