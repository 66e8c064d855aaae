// The photo hull by a plane sweep (Li, Magnor and Seidel 2004, Hardware-accelerated rendering of photo hulls).
//
//   eye  --|---|---|--/-|---|     planes parallel to the picture, from near to far: a pixel gets the colour of the first
//                    hull         plane that is inside the hull and on which the cameras that see it agree
//
// The depth test leaves pixels out that are covered or outside the hull.

// Least and greatest depth of the planes; they lie in the middles of equal parts.
fn plane_depth(plane: f32) -> f32 {
    return mix(eye.planes.x, eye.planes.y, (plane + 0.5) / eye.planes.z);
}

// How far colours may be from their mean, in grey levels. 15 to 30 give pictures of the same quality.
const CONSISTENT: f32 = 20.0;

// Planes behind the entry among which a pixel that no plane covers has a choice.
const REST: f32 = 16.0;

struct Plane {
    @builtin(position) corner: vec4f,
    @location(0) @interpolate(flat) depth: f32,
}

@vertex
fn plane(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Plane {
    let plane = f32(instance);
    return Plane(corner(index, BEHIND * (plane + 0.5) / eye.planes.z), plane_depth(plane));
}

// What the cameras say of a point.
struct Agreement {
    colour: vec3f,
    // Of the colours from their mean, in grey levels; larger than any outside the hull.
    deviation: f32,
}

fn agreement(position: vec3f, t: f32) -> Agreement {
    let direction = eye.world_from_image * position;
    let point = eye.origin.xyz + direction * t;
    let along = normalize(direction);
    var outside = 0u;
    var inside = 0u;
    var sum = vec3f(0.0);
    var squares = vec3f(0.0);
    var total = 0.0;
    var blended = vec3f(0.0);
    var weights = 0.0;
    // each view {
    {
        let h = eye.lines[VIEW].at_origin.xyz + eye.lines[VIEW].slope * position * t;
        let found = sight(views.all[VIEW], VIEWu, h, point, along);
        let colour = colour_in(VIEWu, views.all[VIEW].coloured, h.xy / h.z);
        inside += select(0u, 1u, found.in_image && found.edge <= 0.0);
        outside += select(0u, 1u, found.in_image && found.edge > 0.0);
        sum += found.visible * colour;
        squares += found.visible * colour * colour;
        total += found.visible;
        blended += found.weight * colour;
        weights += found.weight;
    }
    // }
    let in_bounds = all(point >= eye.bounds_min.xyz) && all(point <= eye.bounds_max.xyz);
    let in_hull = in_bounds && outside == 0u && inside >= MIN_VIEWS;
    let mean = sum / max(total, 1e-6);
    let variance = max(squares / max(total, 1e-6) - mean * mean, vec3f(0.0));
    let deviation = select(sqrt((variance.x + variance.y + variance.z) / 3.0), 0.0, total < 1e-6);
    return Agreement(blended / max(weights, 1e-6), select(NOTHING, deviation, in_hull));
}

@fragment
fn sweep(@location(0) @interpolate(flat) depth: f32, @builtin(position) fragment: vec4f) -> Pixel {
    let found = agreement(image_position(fragment.xy), depth);
    if found.deviation > CONSISTENT {
        discard;
    }
    return pixel(found.colour, depth);
}

// What no plane has covered: the depth at which the cameras agree best, among the planes behind the entry.
@fragment
fn rest(@builtin(position) fragment: vec4f) -> Pixel {
    let position = image_position(fragment.xy);
    let t = entry_of(fragment.xy);
    var best = Agreement(vec3f(0.0), 2.0 * NOTHING);
    var depth = t;
    // The first is the entry itself: parts of the hull between two planes have no other depth.
    let first = ceil((t - eye.planes.x) / (eye.planes.y - eye.planes.x) * eye.planes.z - 0.5) - 1.0;
    for (var k = 0.0; k <= REST; k += 1.0) {
        let at = max(t, plane_depth(first + k));
        let found = agreement(position, at);
        let is_better = found.deviation < best.deviation;
        depth = select(depth, at, is_better);
        best.colour = select(best.colour, found.colour, is_better);
        best.deviation = min(best.deviation, found.deviation);
    }
    return pixel(best.colour, depth);
}

// Planes lie between what is masked and this depth of the test.
const BEHIND: f32 = 0.9;

@vertex
fn behind(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return corner(index, BEHIND);
}

// Pixels are masked until the planes come to where their rays enter the hull.
@vertex
fn band(@builtin(vertex_index) index: u32, @builtin(instance_index) band: u32) -> Plane {
    return Plane(corner(index, 1.0), f32(band));
}

@fragment
fn entered_pixels(@location(0) @interpolate(flat) band: f32, @builtin(position) fragment: vec4f) {
    let t = entry_of(fragment.xy);
    let part = clamp((t - eye.planes.x) / (eye.planes.y - eye.planes.x), 0.0, 0.9999);
    if t >= NOTHING || floor(part * eye.planes.z / BAND) != band {
        discard;
    }
}

// All planes from near to far, up to the first that is consistent; the most consistent one where none is.
@fragment
fn plain_sweep(@builtin(position) fragment: vec4f) -> Pixel {
    let position = image_position(fragment.xy);
    var best = Agreement(vec3f(0.0), NOTHING);
    var depth = 0.0;
    for (var k = 0.0; k < eye.planes.z; k += 1.0) {
        let at = plane_depth(k);
        let found = agreement(position, at);
        if found.deviation < best.deviation {
            best = found;
            depth = at;
        }
        if found.deviation <= CONSISTENT {
            break;
        }
    }
    if best.deviation >= NOTHING {
        discard;
    }
    return pixel(best.colour, depth);
}
