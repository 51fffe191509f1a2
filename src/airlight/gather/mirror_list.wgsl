// Lists the pixels that mirror enough for rays of their own.
//! use pixel_point
//! use surface_reflection
//! use packed_pixel

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(params.size))) {
        return;
    }
    let d = textureLoad(depth, id.xy, 0);
    var row = 0u;
    if (d > 0.0) {
        let v = normalize(params.eye - pixel_point(vec2f(id.xy) + 0.5, d));
        // How much the surface mirrors to the eye.
        let base = textureLoad(albedo, id.xy, 0);
        let facing = textureLoad(normal, id.xy, 0);
        let r = reflector(base.rgb, base.a, facing.w, textureLoad(emission, id.xy, 0).a);
        let n_v = max(dot(normalize(facing.xyz), v), 1e-4);
        if (glossy_share(specular_albedo(r, n_v), sqrt(r.alpha)) > 0.0) {
            // Rows count from 1: 0 says that there is none.
            row = atomicAdd(&found[0], 1u) + 1u;
            listed[row - 1u] = packed_pixel(id.xy);
        }
    }
    textureStore(rows, id.xy, vec4u(row, 0u, 0u, 0u));
}
