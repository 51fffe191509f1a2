// One more ray from each metal or smooth coat that a mirrored ray has met; writes the surface that this one meets, in
// the next texel of this segment's.
//! use gather
//! use gather_hit
//! use packed_pixel
//! use ggx_sampling
//! use glow_share

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let at = id.y * params.batch.x + id.x;
    if (any(id.xy >= params.batch) || at >= rays_of_segment(params.segment - 1u)) {
        return;
    }
    let source = textureLoad(starts, id.xy, 0);
    let place = textureLoad(met_positions, id.xy, 0);
    if (source.w <= 0.0 || place.w <= 0.0) {
        return;
    }
    let gloss = glosses[hit_material(place.w)];
    let n = normalize(textureLoad(met_normals, id.xy, 0).xyz);
    // The direction to where the ray came from, about the normal.
    let frame = orthonormal_frame(n);
    var v = normalize(source.xyz - place.xyz) * frame;
    v.z = max(v.z, 1e-4);
    if (gloss.metallic <= 0.0 && coat_share(gloss.f0, gloss.alpha, v.z) <= 0.0) {
        return;
    }
    // A microfacet that is seen from there, and the direction that it mirrors.
    let word = pixels[at];
    let pixel = unpacked_pixel(word);
    let numbers = later_numbers(pixel.x, pixel.y, params.sample, params.segment);
    let mirrored = reflect(-v, visible_normal(v, gloss.alpha, numbers));
    if (mirrored.z > 0.0) {
        let start = place.xyz + params.raised * n;
        let hit = gather_hit(start, frame * mirrored);
        let next = atomicAdd(&found[params.segment], 1u);
        let texel = vec2u(next % params.batch.x, next / params.batch.x);
        next_pixels[next] = word;
        textureStore(next_starts, texel, vec4f(start, packed_glow_share(glow_share(gloss.alpha))));
        store_hit(texel, hit);
    }
}

// How many the segment of this number has, in this batch.
fn rays_of_segment(segment: u32) -> u32 {
    let all = atomicLoad(&found[segment]);
    return all - min(all, select(params.first, 0u, segment > 0u));
}
