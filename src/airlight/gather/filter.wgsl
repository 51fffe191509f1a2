// The light of gather points, shared with neighbours on about the same plane. Source: Dammertz2010
// (edge-avoiding a-trous wavelets), whose steps double from pass to pass.
//! use gather

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let place = textureLoad(places, id.xy, 0);
    let n = textureLoad(planes, id.xy, 0).xyz;
    let own = SUMS * (id.y * params.reduced.x + id.x);
    var sum: array<vec4f, SUMS>;
    let own_inverse_m = before[own].w / before[own + 1u].w;
    let texel_m = params.texel * max(place.w, 1e-9) * f32(params.stride);
    let last = vec2i(params.reduced) - 1;
    var total = 0.0;
    var k = 0;
    loop {
        if (place.w <= 0.0) { break; }
        let offset = vec2i(k % 5, k / 5) - 2;
        let at = vec2i(id.xy) + offset * i32(params.stride);
        if (all(at >= vec2i(0)) && all(at <= last)) {
            let other = textureLoad(places, at, 0);
            let its = textureLoad(planes, at, 0).xyz;
            var weight = exp(-params.falloff * f32(dot(offset, offset)));
            weight *= likeness(place.xyz, n, other.xyz, its, texel_m);
            let index = SUMS * (u32(at.y) * params.reduced.x + u32(at.x));
            let its_inverse_m = before[index].w / max(before[index + 1u].w, 1e-9);
            let inverse_m = 0.5 * (own_inverse_m + its_inverse_m);
            weight *= closeness(distance(place.xyz, other.xyz), inverse_m);
            weight = select(0.0, weight, other.w > 0.0);
            for (var i = 0u; i < SUMS; i++) {
                sum[i] += weight * before[index + i];
            }
            total += weight;
        }
        k++;
        if (k >= 25) { break; }
    }
    let inverse = select(0.0, 1.0 / total, total > 0.0);
    for (var i = 0u; i < SUMS; i++) {
        after[own + i] = inverse * sum[i];
    }
}
