//! use occlusion

// The mean over every phase of the 4 x 4 sampling pattern, on one surface.

const DEPTH_TOLERANCE = 0.05;   // as a share of the depth, per texel of distance

struct Around {
    @location(0) light: vec4f,
    @location(1) way: vec4f,
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Around {
    let texel = vec2i(position.xy);
    let own = textureLoad(sampled_light, texel, 0);
    let last = vec2i(params.reduced) - 1;
    var light = vec3f(0.0);
    var way = vec4f(0.0);
    var hidden = 0.0;
    var total = 0.0;
    for (var k = 0; k < 16; k++) {
        let place = clamp(texel + vec2i(k & 3, k >> 2u) - 1, vec2i(0), last);
        let other = textureLoad(sampled_light, place, 0);
        let weight = select(0.0, 1.0, abs(other.w - own.w) <= DEPTH_TOLERANCE * own.w);
        light += weight * other.rgb;
        way += weight * textureLoad(sampled_way, place, 0);
        hidden += weight * packed_hidden(other.w);
        total += weight;
    }
    return Around(vec4f(light / total, packed_depth(own.w, hidden / total)), way / total);
}
