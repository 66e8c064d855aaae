// A triangle that covers the whole target, at one depth.

// The depth of what is drawn, and of the pixels that the mask leaves out.
const DRAWN: f32 = 0.5;
const MASKED: f32 = 0.0;

fn corner(index: u32, depth: f32) -> vec4f {
    return vec4f(f32((index << 1u) & 2u) * 2.0 - 1.0, f32(index & 2u) * 2.0 - 1.0, depth, 1.0);
}

@vertex
fn screen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner(index, DRAWN);
}

@vertex
fn mask(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner(index, MASKED);
}
