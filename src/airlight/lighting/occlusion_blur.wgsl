// The mean over every phase of the 4 x 4 sampling pattern, on one surface.

const DEPTH_TOLERANCE = 0.05;   // as a share of the depth, per texel of distance

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    let own = textureLoad(sampled, texel, 0);
    let last = vec2i(params.reduced) - 1;
    var sum = 0.0;
    var total = 0.0;
    for (var k = 0; k < 16; k++) {
        let place = clamp(texel + vec2i(k & 3, k >> 2u) - 1, vec2i(0), last);
        let other = textureLoad(sampled, place, 0);
        let weight = select(0.0, 1.0, abs(other.y - own.y) <= DEPTH_TOLERANCE * own.y);
        sum += weight * other.x;
        total += weight;
    }
    return vec4f(sum / total, own.y, 0.0, 0.0);
}
