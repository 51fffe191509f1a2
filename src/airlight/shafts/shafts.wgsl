//! use shaft_rays

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    let ray = picked_ray(rays, id.xy, textureLoad(picked, vec2i(id.xy), 0).xy);
    textureStore(scattered, id.xy, vec4f(single_scattered(ray.direction, ray.distance), ray.distance));
}
