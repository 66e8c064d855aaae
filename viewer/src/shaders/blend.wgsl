// The colours of the subject: those of the real cameras that see a point best, as in cpu/blend.rs.

@group(2) @binding(0) var depth_maps: texture_2d<u32>;

// The fourth power of the angle, in radians, from which on angles are told apart.
const SAME_ANGLE: f32 = 1e-6;

// Pixels from the silhouette's edge within which a camera counts less.
const FEATHER_PX: f32 = 3.0;

// How much a camera counts that does not see a point: the hull of few cameras is so large that it often does.
const UNSEEN: f32 = 0.1;

// How far into the hull colours may agree better than on its surface, in metres, and the number of steps to there.
const REFINED_DEPTH: f32 = 0.08;
const REFINED_STEPS: u32 = 4u;

// How much more colours have to agree for a metre more of depth, in grey levels.
const DEPTH_PENALTY: f32 = 60.0;

// A depth at which colours agree worse by this, in grey levels, counts less by e.
const SOFTNESS: f32 = 5.0;

// The best cameras, and their weights; weights of zero are cameras that do not count.
struct Choice {
    cameras: vec3u,
    weights: vec3f,
}

// The images of a ray in the chosen cameras.
struct Chosen {
    a: array<vec3f, 3>,
    s: array<vec3f, 3>,
    coloured: array<vec4f, 3>,
}

// How well a camera sees a point at this position and depth, 0 to 1.
fn visibility(cells: vec4f, part: vec4f, at: vec2f, depth: f32) -> f32 {
    let pixel = at * layer_size() - MARGIN;
    let cell = clamp(floor(pixel / CELL), cells.xy, cells.zw) + part.xy;
    let hull = bitcast<f32>(textureLoad(depth_maps, vec2i(cell), 0).x);
    return clamp(2.0 - (depth - hull) / VISIBILITY_BIAS, 0.0, 1.0);
}

// What a camera has of a point.
struct Sight {
    // Whether it lies in the image.
    in_image: bool,
    // The distance from the silhouette's edge in pixels, negative inside.
    edge: f32,
    // How well the camera sees it, 0 to 1, and how much its colour counts; nothing without colours.
    visible: f32,
    weight: f32,
}

// What a camera has of a point at homogeneous position h, seen along a unit direction.
fn sight(view: View, index: u32, h: vec3f, point: vec3f, direction: vec3f) -> Sight {
    let at = h.xy / h.z;
    let in_image = h.z > MIN_DEPTH && all(at >= view.image.xy) && all(at < view.image.zw);
    let counts = select(0.0, view.centre.w, in_image);
    let edge = distance_in(index, view.known, at);
    let visible = visibility(view.cells, view.part, at, h.z) * clamp(-edge / FEATHER_PX, 0.0, 1.0);
    // Twice one minus the cosine is the square of a small angle.
    let squared_angle = max(2.0 * (1.0 - dot(normalize(point - view.centre.xyz), direction)), 0.0);
    let angle = max(squared_angle * squared_angle, SAME_ANGLE);
    return Sight(in_image, edge, counts * visible, counts * max(visible, UNSEEN) / angle);
}

// Cameras whose directions from the subject differ by less than this from the viewpoint's may count: its cosine.
const SAME_SIDE: f32 = -0.3233;

fn is_on_same_side(centre: vec3f) -> bool {
    let middle = 0.5 * (eye.bounds_min.xyz + eye.bounds_max.xyz);
    return dot(normalize(centre - middle), normalize(eye.origin.xyz - middle)) > SAME_SIDE;
}

// The best cameras for the point of the ray at t: of those on the viewpoint's side, or of all if there are none.
fn choose(position: vec3f, direction: vec3f, t: f32) -> Choice {
    let point = eye.origin.xyz + direction * t;
    let along = normalize(direction);
    var best = vec4f(0.0);
    var cameras = vec4f(0.0);
    var any_near = false;
    // each view {
    let near_VIEW = views.all[VIEW].centre.w > 0.0 && is_on_same_side(views.all[VIEW].centre.xyz);
    any_near = any_near || near_VIEW;
    // }
    // each view {
    if near_VIEW || !any_near {
        let h = eye.lines[VIEW].at_origin.xyz + eye.lines[VIEW].slope * position * t;
        let found = sight(views.all[VIEW], VIEWu, h, point, along).weight;
        let better = vec4f(found) > best;
        let behind = vec4<bool>(false, better.xyz);
        best = select(best, select(vec4f(found), best.xxyz, behind), better);
        cameras = select(cameras, select(vec4f(VIEW.0), cameras.xxyz, behind), better);
    }
    // }
    // Less the weight of the first camera that is left out: none comes or goes with a step of the colour.
    return Choice(vec3u(cameras.xyz), best.xyz - best.w);
}

fn chosen(choice: Choice, position: vec3f) -> Chosen {
    var found: Chosen;
    for (var k = 0u; k < 3u; k++) {
        let camera = choice.cameras[k];
        found.a[k] = eye.lines[camera].at_origin.xyz;
        found.s[k] = eye.lines[camera].slope * position;
        found.coloured[k] = views.all[camera].coloured;
    }
    return found;
}

// The colours of the chosen cameras at t.
fn colours_at(choice: Choice, lines: Chosen, t: f32) -> mat3x3f {
    let h_0 = lines.a[0] + lines.s[0] * t;
    let h_1 = lines.a[1] + lines.s[1] * t;
    let h_2 = lines.a[2] + lines.s[2] * t;
    return mat3x3f(
        colour_in(choice.cameras.x, lines.coloured[0], h_0.xy / h_0.z),
        colour_in(choice.cameras.y, lines.coloured[1], h_1.xy / h_1.z),
        colour_in(choice.cameras.z, lines.coloured[2], h_2.xy / h_2.z),
    );
}

// How far colours that count are from their mean, in grey levels.
fn deviation(colours: mat3x3f, counts: vec3f, total: f32) -> f32 {
    let mean = colours * counts / total;
    let off = abs(colours[0] - mean) * counts.x + abs(colours[1] - mean) * counts.y + abs(colours[2] - mean) * counts.z;
    return (off.x + off.y + off.z) / (3.0 * total);
}

// The colour (xyz) of the subject where a ray enters the hull at t, and the depth of its surface (w): the mean over depths into
// the hull, weighted by how well the colours of the chosen cameras agree there.
fn refined(choice: Choice, lines: Chosen, direction: vec3f, t: f32) -> vec4f {
    let counts = select(vec3f(0.0), vec3f(1.0), choice.weights > vec3f(0.0));
    let counted = max(counts.x + counts.y + counts.z, 1.0);
    let weights = choice.weights / max(choice.weights.x + choice.weights.y + choice.weights.z, 1e-30);
    let depth_per_metre = 1.0 / length(direction);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var step = 0u; step <= REFINED_STEPS; step++) {
        let deeper = REFINED_DEPTH * f32(step) / f32(REFINED_STEPS);
        let at = t + deeper * depth_per_metre;
        let colours = colours_at(choice, lines, at);
        let weight = exp(-(deviation(colours, counts, counted) + DEPTH_PENALTY * deeper) / SOFTNESS);
        sum += vec4f(colours * weights, at) * weight;
        total += weight;
    }
    return sum / total;
}
