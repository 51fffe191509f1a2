//! use eye_ray

// Depths that differ by less than this share count as one surface.
const SAME_SURFACE = 0.1;

fn distance_at(pixel: vec2u) -> f32 {
    let direction = pixel_direction(rays.world_from_clip, vec2f(pixel) + 0.5, vec2f(rays.size));
    let d = textureLoad(depth, vec2i(pixel), 0);
    return pixel_distance(rays.world_from_clip, direction, d);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    let first = id.xy * rays.scale;
    let middle = rays.scale / 2u;
    var nearest = vec2f(2.0 * EYE_RAY_FAR, 0.0);
    var farthest = vec2f(-1.0, 0.0);
    var chosen = vec2f(-1.0, 0.0);      // the middle one, where the picture has it
    // Tested at its end: software drivers run a body once more than a test before it lets through.
    var index = 0u;
    loop {
        let pixel = first + vec2u(index % rays.scale, index / rays.scale);
        if (all(pixel < rays.size)) {
            let here = vec2f(distance_at(pixel), f32(index));
            if (here.x < nearest.x) { nearest = here; }
            if (here.x > farthest.x) { farthest = here; }
            if (index == middle * rays.scale + middle) { chosen = here; }
        }
        index++;
        if (index >= rays.scale * rays.scale) { break; }
    }
    if (farthest.x - nearest.x > SAME_SURFACE * nearest.x) {
        chosen = select(nearest, farthest, ((id.x + id.y) & 1u) == 1u);
    } else if (chosen.x < 0.0) {
        chosen = nearest;
    }
    textureStore(picked, id.xy, vec4f(chosen, 0.0, 0.0));
}
