// Sparse samples of a reduced image: every second texel of every second row, even and odd ones in turn, so
// that both sides of depth edges (media/rays.py) have some.
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
