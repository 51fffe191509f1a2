// Single scattering along the ray of every texel of an image.
//! use shaft_rays
//! use eye_ray

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    // Invocations beyond the image follow its last texels, and store nothing.
    let texel = min(id.xy, rays.reduced - 1u);
    let ray = picked_ray(rays, texel, textureLoad(picked, vec2i(texel), 0).xy);
    let drawn = single_scattered(ray.direction, ray.distance);
    if (all(id.xy < rays.reduced)) {
        textureStore(scattered, texel, vec4f(drawn, ray.distance));
    }
}
