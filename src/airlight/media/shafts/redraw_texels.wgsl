// Samples the listed texels of a reduced image.
//! use shaft_rays

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u,
) {
    let count = found[0];
    var i = id.x;
    if (i >= count) {
        return;
    }
    loop {
        let packed = chosen[i].w;
        let texel = vec2u(packed & 0xffffu, packed >> 16u);
        let ray = picked_ray(rays, texel, textureLoad(picked, vec2i(texel), 0).xy);
        let drawn = single_scattered(ray.direction, ray.distance);
        textureStore(scattered, texel, vec4f(drawn, ray.distance));
        i += groups.x * WX;
        if (i >= count) { break; }
    }
}
