// Where rays enter the visual hull: sphere tracing on the distances of the silhouettes, as in cpu/march.rs.

// The smallest leap, in pixels of the view that decides.
const MIN_LEAP_PX: f32 = 0.25;

// How far a ray goes on where too few views see it, in metres.
const BLIND_STEP: f32 = 0.01;

// Rounds over all views. A ray that grazes many edges ends here.
const MAX_ROUNDS: u32 = 64u;

struct Entry {
    t: f32,
    // The view whose silhouette ends the hull there.
    view: u32,
    found: bool,
}

// How far the ray goes on from this depth in a view before its image has moved by so many pixels.
fn leap(distance_px: f32, depth: f32, slope: f32, speed: f32) -> f32 {
    let slower = speed - distance_px * depth * slope;
    // A ray that flees from the camera may never move so far.
    return select(distance_px * depth * depth / slower, 1e30, slower <= 0.0);
}

// Where the ray of an image position enters the hull within a range of t.
fn entry(position: vec3f, within: vec2f) -> Entry {
    let direction = eye.world_from_image * position;
    var range = clip_to_bounds(direction, within, 0.0);
    // each view {
    let a_VIEW = eye.lines[VIEW].at_origin.xyz;
    let s_VIEW = eye.lines[VIEW].slope * position;
    // The speed of the image is this over the squared depth, in pixels.
    let speed_VIEW = length(layer_size() * (s_VIEW.xy * a_VIEW.z - a_VIEW.xy * s_VIEW.z));
    if !ABSTAINS {
        range = clip_to_rect(views.all[VIEW].rect, a_VIEW, s_VIEW, range);
    }
    // }

    var t = range.x;
    let to = range.y;
    // Before the last leap: t, the distance, and the distance after it.
    var before = vec3f(t, 1.0, 0.0);
    var decided_by = 0u;
    var arrived = false;
    for (var round = 0u; round < MAX_ROUNDS; round++) {
        let begin = t;
        var seen = 0u;
        // each view {
        {
            var leapt = false;
            loop {
                let h = a_VIEW + s_VIEW * t;
                let at = h.xy / h.z;
                var distance = distance_in(VIEWu, views.all[VIEW].known, at);
                if ABSTAINS {
                    let image = views.all[VIEW].image;
                    let is_seen = h.z > MIN_DEPTH && all(at >= image.xy) && all(at < image.zw);
                    seen += select(0u, 1u, is_seen && distance <= 0.0);
                    distance = select(-1e-6, distance, is_seen);
                }
                before.z = select(before.z, distance, leapt);
                if !(distance > 0.0) || t > to {
                    break;
                }
                before = vec3f(t, distance, 0.0);
                decided_by = VIEWu;
                leapt = true;
                t += leap(max(distance, MIN_LEAP_PX), h.z, s_VIEW.z, speed_VIEW);
            }
        }
        // }
        if t > to {
            break;
        }
        if t == begin {
            if !ABSTAINS || seen >= MIN_VIEWS {
                arrived = true;
                break;
            }
            before = vec3f(t, 1.0, 0.0);
            t += BLIND_STEP;
        }
    }
    // Linear between the last two distances in the view that decides.
    let entered = before.x + (t - before.x) * before.y / (before.y - before.z);
    return Entry(entered, decided_by, arrived);
}
