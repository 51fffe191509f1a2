// The light of gather points, shared with neighbours on about the same plane. Source: Dammertz2010
// (edge-avoiding a-trous wavelets), whose steps double from pass to pass.
//! use gather

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let place = textureLoad(places, id.xy, 0);
    let n = textureLoad(normals, id.xy, 0).xyz;
    let own = id.y * params.reduced.x + id.x;
    var surfaces = vec4f(0.0);
    var sky = vec4f(0.0);
    let own_light = before[2u * own];
    let own_count = before[2u * own + 1u].w;
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
            let its = textureLoad(normals, at, 0).xyz;
            var weight = exp(-params.falloff * f32(dot(offset, offset)));
            weight *= likeness(place.xyz, n, other.xyz, its, texel_m);
            let index = 2u * (u32(at.y) * params.reduced.x + u32(at.x));
            let its_light = before[index];
            let its_sky = before[index + 1u];
            let inverse_m = 0.5 * (own_light.w / own_count + its_light.w / max(its_sky.w, 1e-9));
            weight *= closeness(distance(place.xyz, other.xyz), inverse_m);
            weight = select(0.0, weight, other.w > 0.0);
            surfaces += weight * its_light;
            sky += weight * its_sky;
            total += weight;
        }
        k++;
        if (k >= 25) { break; }
    }
    let inverse = select(0.0, 1.0 / total, total > 0.0);
    after[2u * own] = surfaces * inverse;
    after[2u * own + 1u] = sky * inverse;
}
