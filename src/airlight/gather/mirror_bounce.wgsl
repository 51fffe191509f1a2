// One more ray from each metal or smooth coat that a mirrored ray has met; writes the surface that this one meets.
//! use gather
//! use gather_hit
//! use packed_pixel
//! use ggx_sampling
//! use glow_share

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.batch)) {
        return;
    }
    let row = params.first + id.y * params.batch.x + id.x;
    let source = textureLoad(starts, id.xy, 0);
    let place = textureLoad(met_positions, id.xy, 0);
    var hit = no_ray();
    var start = vec4f(0.0);
    if (source.w > 0.0 && place.w > 0.0) {
        let gloss = glosses[hit_material(place.w)];
        let n = normalize(textureLoad(met_normals, id.xy, 0).xyz);
        // The direction to where the ray came from, about the normal.
        let frame = orthonormal_frame(n);
        var v = normalize(source.xyz - place.xyz) * frame;
        v.z = max(v.z, 1e-4);
        if (gloss.metallic > 0.0 || coat_share(gloss.f0, gloss.alpha, v.z) > 0.0) {
            let pixel = unpacked_pixel(listed[row]);
            // A microfacet that is seen from there, and the direction that it mirrors.
            let numbers = later_numbers(pixel.x, pixel.y, params.sample, params.segment);
            let mirrored = reflect(-v, visible_normal(v, gloss.alpha, numbers));
            if (mirrored.z > 0.0) {
                start = vec4f(place.xyz + params.raised * n, packed_glow_share(glow_share(gloss.alpha)));
                hit = gather_hit(start.xyz, frame * mirrored);
            }
        }
    }
    textureStore(next_starts, id.xy, start);
    store_hit(id.xy, hit);
}
