// The pixel of a block whose ray a reduced texel takes; see rays.py.
//! use eye_ray

// Depths that differ by less than this share count as one surface.
const SAME_SURFACE = 0.1;

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let id = vec2u(position.xy);
    let size = vec2f(rays.size);
    let first = id * rays.scale;
    let middle = rays.scale / 2u;
    // Directions are linear over the image; see pixel_direction.
    let corner = pixel_direction(rays.world_from_clip, vec2f(first) + 0.5, size);
    let right = rays.world_from_clip[0].xyz * (2.0 / size.x);
    let down = rays.world_from_clip[1].xyz * (-2.0 / size.y);
    let near = 1.0 / rays.world_from_clip[2].w;
    var nearest = vec2f(2.0 * EYE_RAY_FAR, 0.0);
    var farthest = vec2f(-1.0, 0.0);
    var chosen = vec2f(-1.0, 0.0);      // the middle one, where the image has it
    // The loop is tested at its end: CPU adapters run a body once more than a test at its head passes.
    var index = 0u;
    loop {
        let inside = texel_pixel(index, rays.scale);
        let pixel = first + inside;
        let direction = corner + f32(inside.x) * right + f32(inside.y) * down;
        let shown = textureLoad(depth, min(pixel, rays.size - 1u), 0);
        let reach = min(length(direction) * near / max(shown, 1e-30), EYE_RAY_FAR);
        let here = vec2f(select(reach, EYE_RAY_FAR, shown <= 0.0), f32(index));
        let is_in = all(pixel < rays.size);
        nearest = select(nearest, here, is_in && here.x < nearest.x);
        farthest = select(farthest, here, is_in && here.x > farthest.x);
        chosen = select(chosen, here, is_in && index == middle * rays.scale + middle);
        index++;
        if (index >= rays.scale * rays.scale) { break; }
    }
    // At an edge the nearest and the farthest one in turn, else the middle one.
    let edge = select(nearest, farthest, ((id.x + id.y) & 1u) == 1u);
    let middle_one = select(chosen, nearest, chosen.x < 0.0);
    let is_edge = farthest.x - nearest.x > SAME_SURFACE * nearest.x;
    return vec4f(select(middle_one, edge, is_edge), 0.0, 0.0);
}
