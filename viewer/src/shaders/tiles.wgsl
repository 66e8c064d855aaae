// Tiles of a target in which no ray comes near the hull are masked, and rays of the others start where the tile's do.
//
// The middle of a tile leaps as a ray does, but only as far as all rays of the tile may.

@group(3) @binding(0) var tiles: texture_2d<u32>;

// Pixels of the target along a side of a tile.
const TILE: f32 = 8.0;

// Larger than any depth.
const NOTHING: f32 = 1e30;

// t at which the rays of a tile come near the hull.
fn tile_start(fragment: vec2f) -> f32 {
    return bitcast<f32>(textureLoad(tiles, vec2i(fragment / TILE), 0).x);
}

@fragment
fn masked_tiles(@builtin(position) fragment: vec4f) {
    if tile_start(fragment.xy) < NOTHING {
        discard;
    }
}

@fragment
fn tile(@builtin(position) fragment: vec4f) -> @location(0) u32 {
    let position = image_position(fragment.xy * TILE);
    let direction = eye.world_from_image * position;
    let range = clip_to_bounds(direction, vec2f(0.0, NOTHING), eye.light.w);
    // How far rays of the tile are from its middle, for each metre of depth.
    let widening = eye.origin.w;
    var t = range.x;
    for (var round = 0u; round < MAX_ROUNDS; round++) {
        let begin = t;
        // each view {
        {
            let a = eye.lines[VIEW].at_origin.xyz;
            let s = eye.lines[VIEW].slope * position;
            let focal = eye.lines[VIEW].at_origin.w;
            let centre = views.all[VIEW].centre.xyz;
            // The greatest speed and the least depth and slope of all rays of the tile.
            let speed = length(layer_size() * (s.xy * a.z - a.xy * s.z))
                + widening * focal * distance(centre, eye.origin.xyz);
            loop {
                let h = a + s * t;
                let depth = h.z - widening * t;
                let from_centre = distance(centre, eye.origin.xyz + direction * t);
                let apart = widening * t * focal * from_centre / (depth * depth);
                let gap = select(0.0, tile_distance(VIEWu, views.all[VIEW], h) - apart, depth > MIN_DEPTH);
                if gap < MIN_LEAP_PX || t > range.y {
                    break;
                }
                t += leap(gap, depth, s.z - widening, speed);
            }
        }
        // }
        if t == begin || t > range.y {
            break;
        }
    }
    return bitcast<u32>(select(t, NOTHING, t > range.y));
}

// Pixels from the silhouette to homogeneous position h, at least, and nothing where the view may abstain.
fn tile_distance(index: u32, view: View, h: vec3f) -> f32 {
    let at = h.xy / h.z;
    let beyond = length((at - clamp(at, view.known.xy, view.known.zw)) * layer_size());
    let may_abstain = ABSTAINS && !(all(at >= view.image.xy) && all(at < view.image.zw));
    return select(max(distance_in(index, view.known, at), beyond), 0.0, may_abstain);
}
