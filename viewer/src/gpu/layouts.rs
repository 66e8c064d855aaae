//! What shaders are given: the layouts of their bind groups.

use super::device::Device;

/// The layouts of all bind groups.
#[derive(Debug)]
pub struct Layouts {
    /// Group 0: the views and their texture arrays.
    pub scene: wgpu::BindGroupLayout,
    /// Group 1: one of several viewpoints.
    pub eye: wgpu::BindGroupLayout,
    /// Groups 2 and 3: depths that an earlier pass has drawn.
    pub depths: wgpu::BindGroupLayout,
    pub bilinear: wgpu::Sampler,
}

impl Layouts {
    /// The layouts on `device`.
    pub fn new(device: &Device) -> Self {
        use wgpu::TextureSampleType as Type;
        use wgpu::TextureViewDimension as Dimension;
        let floats = texture(Type::Float { filterable: true }, Dimension::D2Array);
        let bits = texture(Type::Uint, Dimension::D2);
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        Self {
            scene: layout(device, "scene", &[uniform(false), floats, floats, sampler]),
            eye: layout(device, "eye", &[uniform(true)]),
            depths: layout(device, "depths", &[bits]),
            bilinear: device.raw().create_sampler(&wgpu::SamplerDescriptor {
                label: Some("bilinear"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
        }
    }
}

fn uniform(has_dynamic_offset: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset,
        min_binding_size: None,
    }
}

fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

fn layout(device: &Device, label: &str, bindings: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let entries: Vec<_> = (0..).zip(bindings).map(entry).collect();
    device
        .raw()
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A bind group whose bindings are `resources`, in order.
pub fn bind(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    resources: Vec<wgpu::BindingResource>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    device.raw().create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
}
