// The normal of the surface that a pixel shows, without relief, from the depth around it. The including pass
// binds `depth`, and what pixel_point needs.
//! use pixel_point

// From the pixel's point `p` to that of the neighbour at `step` or opposite, whichever is nearer to it.
fn along_surface(pixel: vec2i, p: vec3f, step: vec2i) -> vec3f {
    let last = vec2i(params.size) - 1;
    let ahead = clamp(pixel + step, vec2i(0), last);
    let behind = clamp(pixel - step, vec2i(0), last);
    let d_ahead = textureLoad(depth, ahead, 0);
    let d_behind = textureLoad(depth, behind, 0);
    let to = pixel_point(vec2f(ahead) + 0.5, d_ahead) - p;
    let from_there = p - pixel_point(vec2f(behind) + 0.5, d_behind);
    let is_back = (dot(from_there, from_there) < dot(to, to) && any(behind != pixel)) || all(ahead == pixel);
    return select(to, from_there, is_back);
}

// Unit, towards the eye; `shading` where the depth around says nothing.
fn flat_normal(pixel: vec2i, p: vec3f, shading: vec3f) -> vec3f {
    let made = cross(along_surface(pixel, p, vec2i(1, 0)), along_surface(pixel, p, vec2i(0, 1)));
    let squared = dot(made, made);
    let unit = made * inverseSqrt(max(squared, 1e-37));
    let turned = select(unit, -unit, dot(unit, p - params.eye) > 0.0);
    return select(shading, turned, squared > 1e-36 && dot(turned, shading) > 0.2);
}
