// One texel in four of a reduced image, first: every second one of every second row, by turns the
// even and the odd ones, so that both sides of depth edges (media/rays.py) have theirs.
//! use shaft_rays
//! use sparse_texels

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let texel = min(texel_of_sample(id.xy), rays.reduced - 1u);
    let ray = picked_ray(rays, texel, textureLoad(picked, vec2i(texel), 0).xy);
    let drawn = single_scattered(ray.direction, ray.distance);
    if (all(id.xy < (rays.reduced + 1u) / 2u)) {
        textureStore(scattered, id.xy, vec4f(drawn, ray.distance));
    }
}
