// How far the hull is from each real camera, as in cpu/depth_map.rs.

// Cells outside the camera's own silhouette are masked too.
@fragment
fn masked_cells(@builtin(position) fragment: vec4f) {
    let own = u32(eye.placement.w);
    let position = image_position(fragment.xy);
    let at = eye.lines[own].slope * position;
    let is_own = distance_in(own, views.all[own].known, at.xy / at.z) <= CELL;
    if is_own && tile_start(fragment.xy) < NOTHING {
        discard;
    }
}

@fragment
fn depth_map(@builtin(position) fragment: vec4f) -> @location(0) u32 {
    let found = entry(image_position(fragment.xy), vec2f(tile_start(fragment.xy), NOTHING));
    if !found.found {
        discard;
    }
    return bitcast<u32>(found.t);
}
