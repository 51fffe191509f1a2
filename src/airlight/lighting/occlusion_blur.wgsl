// The mean over every phase of the 4 x 4 sampling pattern, on one surface.
//! use near_field_texel

const DEPTH_TOLERANCE = 0.05;   // as a share of the depth, per texel of distance

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4u {
    let texel = vec2i(position.xy);
    let own = bitcast<f32>(textureLoad(sampled, texel, 0).w);
    let last = vec2i(params.reduced) - 1;
    var light = vec3f(0.0);
    var direction = vec4f(0.0);
    var open = 0.0;
    var total = 0.0;
    var k = 0;
    loop {
        let place = clamp(texel + vec2i(k & 3, k >> 2u) - 1, vec2i(0), last);
        let other = textureLoad(sampled, place, 0);
        let near = near_field_of(other);
        // Texels of another depth are of another surface.
        let off = abs(bitcast<f32>(other.w) - own);
        let weight = select(0.0, 1.0, off <= DEPTH_TOLERANCE * own);
        light += weight * near.light;
        direction += weight * vec4f(near.direction, near.hidden);
        open += weight * near.open;
        total += weight;
        k++;
        if (k > 15) { break; }
    }
    direction /= total;
    return packed_near_field(NearField(open / total, light / total, direction.xyz, direction.w), own);
}
