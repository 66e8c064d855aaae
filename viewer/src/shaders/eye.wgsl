// The viewpoint: the rays of its pixels and their images in the views. Along a ray, t is the depth along the viewpoint's axis.

// The image of a ray in a view: at_origin + t (slope * image position), homogeneous.
struct Line {
    // w: the greater focal length in pixels.
    at_origin: vec4f,
    slope: mat3x3f,
}

struct Eye {
    // Maps homogeneous image positions to directions in the world, of length 1 along the axis.
    world_from_image: mat3x3f,
    // w: how many metres the rays of a tile are apart from its middle, for each metre of depth.
    origin: vec4f,
    // x: image pixels for each pixel of the target; yz: the image position of its corner; w: the view whose depth map is drawn.
    placement: vec4f,
    // Corners of the work volume; w: width and height of a layer in pixels.
    bounds_min: vec4f,
    bounds_max: vec4f,
    // w: the same in metres, behind the work volume.
    light: vec4f,
    // Least and greatest depth of a sweep, and the number of its planes.
    planes: vec4f,
    lines: array<Line, VIEWS>,
}

@group(1) @binding(0) var<uniform> eye: Eye;

// The homogeneous image position of the pixel whose centre is at this position of the target.
fn image_position(fragment: vec2f) -> vec3f {
    return vec3f(fragment * eye.placement.x + eye.placement.yz, 1.0);
}

// Width and height of a layer in pixels.
fn layer_size() -> vec2f {
    return vec2f(eye.bounds_min.w, eye.bounds_max.w);
}

// The part of the range (least and greatest t) in which at_0 + slope t >= 0; empty ranges end before they begin.
fn clip(range: vec2f, at_0: f32, slope: f32) -> vec2f {
    let root = -at_0 / slope;
    let from_root = vec2f(max(range.x, root), range.y);
    let to_root = vec2f(range.x, min(range.y, root));
    let parallel = select(range, vec2f(1.0, 0.0), at_0 < 0.0);
    return select(select(parallel, to_root, slope < 0.0), from_root, slope > 0.0);
}

// The part of the range in the work volume and so many metres around it.
fn clip_to_bounds(direction: vec3f, range: vec2f, margin: f32) -> vec2f {
    var part = range;
    for (var axis = 0u; axis < 3u; axis++) {
        part = clip(part, eye.origin[axis] - eye.bounds_min[axis] + margin, direction[axis]);
        part = clip(part, eye.bounds_max[axis] - eye.origin[axis] + margin, -direction[axis]);
    }
    return part;
}

// The part of the range whose image lies in front of the camera and in the rectangle.
fn clip_to_rect(rect: vec4f, at_origin: vec3f, slope: vec3f, range: vec2f) -> vec2f {
    var part = clip(range, at_origin.z - MIN_DEPTH, slope.z);
    part = clip(part, at_origin.x - rect.x * at_origin.z, slope.x - rect.x * slope.z);
    part = clip(part, rect.z * at_origin.z - at_origin.x, rect.z * slope.z - slope.x);
    part = clip(part, at_origin.y - rect.y * at_origin.z, slope.y - rect.y * slope.z);
    return clip(part, rect.w * at_origin.z - at_origin.y, rect.w * slope.z - slope.y);
}
