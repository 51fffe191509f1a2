//! use eye_ray

// Depths that differ by less than this share count as one surface.
const SAME_SURFACE = 0.1;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    // Read before anything branches: a software driver reads buffers once for all lanes there.
    let own = rays;
    let size = vec2f(own.size);
    let first = id.xy * own.scale;
    let middle = own.scale / 2u;
    // Directions are linear over the picture; see pixel_direction.
    let corner = pixel_direction(own.world_from_clip, vec2f(first) + 0.5, size);
    let right = own.world_from_clip[0].xyz * (2.0 / size.x);
    let down = own.world_from_clip[1].xyz * (-2.0 / size.y);
    let near = 1.0 / own.world_from_clip[2].w;
    var nearest = vec2f(2.0 * EYE_RAY_FAR, 0.0);
    var farthest = vec2f(-1.0, 0.0);
    var chosen = vec2f(-1.0, 0.0);      // the middle one, where the picture has it
    // Tested at its end: software drivers run a body once more than a test before it lets through.
    var index = 0u;
    loop {
        let inside = vec2u(index % own.scale, index / own.scale);
        let pixel = first + inside;
        let way = corner + f32(inside.x) * right + f32(inside.y) * down;
        let shown = textureLoad(depth, vec2i(min(pixel, own.size - 1u)), 0);
        let reach = min(length(way) * near / max(shown, 1e-30), EYE_RAY_FAR);
        let here = vec2f(select(reach, EYE_RAY_FAR, shown <= 0.0), f32(index));
        let is_in = all(pixel < own.size);
        nearest = select(nearest, here, is_in && here.x < nearest.x);
        farthest = select(farthest, here, is_in && here.x > farthest.x);
        chosen = select(chosen, here, is_in && index == middle * own.scale + middle);
        index++;
        if (index >= own.scale * own.scale) { break; }
    }
    let edge = select(nearest, farthest, ((id.x + id.y) & 1u) == 1u);
    let even = select(chosen, nearest, chosen.x < 0.0);
    let is_edge = farthest.x - nearest.x > SAME_SURFACE * nearest.x;
    if (all(id.xy < own.reduced)) {
        textureStore(picked, id.xy, vec4f(select(even, edge, is_edge), 0.0, 0.0));
    }
}
