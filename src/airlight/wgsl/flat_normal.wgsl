// The normal of the surface that a pixel shows, without relief, from the depth around it. The including pass
// binds `depth`, and what pixel_point needs.
//! use pixel_point

fn depth_at(pixel: vec2i) -> f32 {
    return textureLoad(depth, clamp(pixel, vec2i(0), vec2i(params.size) - 1), 0);
}

// From the pixel's point `p` at depth `d` to that of the neighbour at `step`, or from the one opposite: on whichever
// side depth goes on as it began. Along planes it is linear across the image, so corners and edges show.
fn along_surface(pixel: vec2i, p: vec3f, d: f32, step: vec2i) -> vec3f {
    let ahead = depth_at(pixel + step);
    let behind = depth_at(pixel - step);
    let bend_ahead = abs(d - 2.0 * ahead + depth_at(pixel + 2 * step));
    let bend_behind = abs(d - 2.0 * behind + depth_at(pixel - 2 * step));
    let is_first = any(pixel - 2 * step < vec2i(0));
    let is_last = any(pixel + 2 * step >= vec2i(params.size));
    let is_back = is_last || (bend_behind < bend_ahead && !is_first);
    let position = vec2f(select(pixel + step, pixel - step, is_back)) + 0.5;
    let to = pixel_point(position, select(ahead, behind, is_back)) - p;
    return select(to, -to, is_back);
}

// Unit, towards the eye; `shading` where the depth around says nothing.
fn flat_normal(pixel: vec2i, p: vec3f, shading: vec3f) -> vec3f {
    let d = depth_at(pixel);
    let made = cross(along_surface(pixel, p, d, vec2i(1, 0)), along_surface(pixel, p, d, vec2i(0, 1)));
    let squared = dot(made, made);
    let unit = made * inverseSqrt(max(squared, 1e-37));
    let turned = select(unit, -unit, dot(unit, p - params.eye) > 0.0);
    return select(shading, turned, squared > 1e-36 && dot(turned, shading) > 0.2);
}
