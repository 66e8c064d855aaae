// The subject in a picture.

// Alpha of the subject in a picture: what its pixels show.
const SUBJECT: f32 = 128.0 / 255.0;

struct Pixel {
    @location(0) colour: vec4f,
    @location(1) depth: u32,
}

fn pixel(colour: vec3f, t: f32) -> Pixel {
    return Pixel(vec4f(colour / 255.0, SUBJECT), bitcast<u32>(t));
}

@group(3) @binding(0) var entries: texture_2d<u32>;

// Where the ray of each pixel enters the hull, and the view that decides.
@fragment
fn hull_entry(@builtin(position) fragment: vec4f) -> @location(0) vec2u {
    let found = entry(image_position(fragment.xy), vec2f(tile_start(fragment.xy), NOTHING));
    if !found.found {
        discard;
    }
    return vec2u(bitcast<u32>(found.t), found.view);
}

// The depth at which the ray of a pixel enters the hull.
fn entry_of(fragment: vec2f) -> f32 {
    return bitcast<f32>(textureLoad(entries, vec2i(fragment), 0).x);
}

@fragment
fn masked_pixels(@builtin(position) fragment: vec4f) {
    if entry_of(fragment.xy) < NOTHING {
        discard;
    }
}

// The hull, coloured by the real cameras.
@fragment
fn blend(@builtin(position) fragment: vec4f) -> Pixel {
    let position = image_position(fragment.xy);
    let direction = eye.world_from_image * position;
    let t = entry_of(fragment.xy);
    let choice = choose(position, direction, t);
    let lines = chosen(choice, position);
    if REFINES {
        let found = refined(choice, lines, direction, t);
        return pixel(found.xyz, found.w);
    }
    let total = choice.weights.x + choice.weights.y + choice.weights.z;
    let sum = colours_at(choice, lines, t) * choice.weights;
    return pixel(select(sum, sum / total, total > 0.0), t);
}

// The hull's shape, lit.
@fragment
fn hull(@builtin(position) fragment: vec4f) -> Pixel {
    let found = textureLoad(entries, vec2i(fragment.xy), 0).xy;
    let t = bitcast<f32>(found.x);
    let point = eye.origin.xyz + eye.world_from_image * image_position(fragment.xy) * t;
    let outward = normal(point, found.y);
    // As in cpu/pixel.rs.
    let side = dot(outward, vec3f(0.5, -0.7, 0.5));
    let brightness = 0.60 + 0.12 * outward.z + 0.16 * side - 0.16 * dot(outward, eye.light.xyz);
    return pixel(vec3f(190.0 * brightness), t);
}

// The outward unit normal of the hull at a point on its surface, where a view decides.
fn normal(point: vec3f, view: u32) -> vec3f {
    // Over three pixels, so that steps of pixels are smoothed.
    const REACH: f32 = 3.0;
    let projection = views.all[view].projection;
    let known = views.all[view].known;
    let h = vec4f(point, 1.0) * projection;
    let image = h.xy / h.z;
    let at = (image + MARGIN) / layer_size();
    let u = vec2f(REACH, 0.0) / layer_size();
    let v = vec2f(0.0, REACH) / layer_size();
    let gradient = vec2f(
        distance_in(view, known, at + u) - distance_in(view, known, at - u),
        distance_in(view, known, at + v) - distance_in(view, known, at - v),
    );
    let along_u = projection[0].xyz - projection[2].xyz * image.x;
    let along_v = projection[1].xyz - projection[2].xyz * image.y;
    let outward = along_u * gradient.x + along_v * gradient.y;
    let steepness = length(outward);
    return select(vec3f(0.0, 0.0, 1.0), outward / steepness, steepness > 1e-12);
}
