// The views of the scene: their silhouettes and images are layers of two arrays. Positions in a layer go from 0 to 1.
//
// Loops over views are written once and expanded (shader.rs): VIEW is the number of the view. With a number that a shader
// computes, Mesa's rasteriser reads uniforms pixel by pixel.

struct View {
    // Least and greatest position: of the silhouette and a pixel around it, of the image, of pixel centres whose distances
    // are known, and of pixel centres whose colours are known.
    rect: vec4f,
    image: vec4f,
    known: vec4f,
    coloured: vec4f,
    // Least and greatest column and row of the depth map, and the place of the view's part of the atlas.
    cells: vec4f,
    part: vec4f,
    // The projection from the world to pixels, by rows.
    projection: mat3x4f,
    // Its centre, and 1 if it has colours.
    centre: vec4f,
}

struct Views {
    all: array<View, VIEWS>,
}

@group(0) @binding(0) var<uniform> views: Views;
@group(0) @binding(1) var distances: texture_2d_array<f32>;
@group(0) @binding(2) var photos: texture_2d_array<f32>;
@group(0) @binding(3) var bilinear: sampler;

// The smallest depth in front of a camera, in metres.
const MIN_DEPTH: f32 = 1e-3;

// The signed distance from the silhouette's edge in pixels, negative inside.
fn distance_in(view: u32, known: vec4f, position: vec2f) -> f32 {
    return textureSampleLevel(distances, bilinear, clamp(position, known.xy, known.zw), view, 0.0).x;
}

// Red, green, blue from 0 to 255.
fn colour_in(view: u32, coloured: vec4f, position: vec2f) -> vec3f {
    return 255.0 * textureSampleLevel(photos, bilinear, clamp(position, coloured.xy, coloured.zw), view, 0.0).rgb;
}
