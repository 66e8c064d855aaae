//! The passes of one picture.

use super::device::Device;
use super::layouts::Layouts;
use super::pipelines::{Pass, Pipelines};
use super::prepared::Prepared;
use super::shader::BAND;
use super::target::{Target, clear, clear_depths, cleared_mask};
use crate::picture::{DrawOptions, Method};
use std::ops::Range;

/// A picture that is being drawn.
#[derive(Debug)]
pub struct Frame<'f> {
    pub device: &'f Device,
    pub layouts: &'f Layouts,
    pub pipelines: &'f mut Pipelines,
    pub prepared: &'f Prepared,
    pub target: &'f Target,
    /// The pixels in which the subject may be: first column and row, and their numbers.
    pub area: [u32; 4],
    pub encoder: &'f mut wgpu::CommandEncoder,
}

impl Frame<'_> {
    /// Where the rays of all pixels enter the hull.
    pub fn entries(&mut self) {
        let [tiles, mask, entry] =
            [Pass::Tiles, Pass::MaskedTiles, Pass::Entry].map(|pass| self.pipeline(pass, false));
        let Self { prepared, target, area: [x, y, width, height], .. } = *self;
        {
            let mut pass = target.tiles.begin(self.encoder);
            prepared.bind(&mut pass, 0);
            pass.set_pipeline(&tiles);
            pass.draw(0..3, 0..1);
        }
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("entries"),
            color_attachments: &[Some(clear_depths(&target.entry_view))],
            depth_stencil_attachment: Some(cleared_mask(&target.mask_view)),
            ..Default::default()
        });
        prepared.bind(&mut pass, 0);
        pass.set_bind_group(3, &target.tiles.group, &[]);
        pass.set_scissor_rect(x, y, width, height);
        for pipeline in [&mask, &entry] {
            pass.set_pipeline(pipeline);
            pass.draw(0..3, 0..1);
        }
    }

    /// The subject where rays enter.
    pub fn subject(&mut self, options: &DrawOptions) {
        let passes = match options.method {
            Method::Blend => vec![(Pass::MaskedPixels, 0..1), (Pass::Blend, 0..1)],
            Method::Hull => vec![(Pass::MaskedPixels, 0..1), (Pass::Hull, 0..1)],
            Method::Sweep if options.cull_planes => sweep(options.planes.max(1)),
            Method::Sweep => vec![(Pass::PlainSweep, 0..1)],
        };
        let pipelines =
            passes.iter().map(|(pass, _)| self.pipeline(*pass, options.refine && *pass == Pass::Blend));
        let pipelines: Vec<_> = pipelines.collect();
        let Self { prepared, target, area: [x, y, width, height], .. } = *self;
        let mut mask = cleared_mask(&target.mask_view);
        if options.method == Method::Sweep && options.cull_planes {
            // All is masked at first.
            mask.depth_ops =
                Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard });
        }
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("subject"),
            color_attachments: &[
                Some(clear(&target.colour_view, wgpu::Color::TRANSPARENT)),
                Some(clear_depths(&target.depth_view)),
            ],
            depth_stencil_attachment: Some(mask),
            ..Default::default()
        });
        prepared.bind(&mut pass, 0);
        pass.set_bind_group(2, &prepared.depth_map_group, &[]);
        pass.set_bind_group(3, &target.entry_group, &[]);
        pass.set_scissor_rect(x, y, width, height);
        for (pipeline, (_, instances)) in pipelines.iter().zip(passes) {
            pass.set_pipeline(pipeline);
            pass.draw(0..3, instances);
        }
    }

    fn pipeline(&mut self, pass: Pass, refines: bool) -> wgpu::RenderPipeline {
        self.pipelines.get(self.device, self.layouts, self.prepared.variant(refines), pass)
    }
}

/// The passes of a sweep: one draw for each plane, from near to far.
fn sweep(planes: u32) -> Vec<(Pass, Range<u32>)> {
    let bands = (0..planes.div_ceil(BAND)).flat_map(|band| {
        let planes = BAND * band..planes.min(BAND * (band + 1));
        let planes = planes.map(|plane| (Pass::Sweep, plane..plane + 1));
        [(Pass::EnteredPixels, band..band + 1)].into_iter().chain(planes)
    });
    bands.chain([(Pass::Rest, 0..1)]).collect()
}
