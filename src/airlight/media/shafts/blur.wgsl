// The mean of 4 x 4 texels of about the same depth: all sixteen offsets of the jitter.

// Texels farther off than this share of the depth do not count.
const DEPTH_TOLERANCE = 0.1;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    let own = textureLoad(picked, vec2i(id.xy), 0).x;
    let last = vec2i(rays.reduced) - 1;
    // Each offset of the jitter occurs once among the texels; those of other surfaces do not count.
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var k = 0; k < 16; k++) {
        let texel = vec2i(id.xy) + vec2i(k & 3, k >> 2u) - 1;
        if (all(texel >= vec2i(0)) && all(texel <= last)) {
            let other = textureLoad(picked, texel, 0).x;
            let off = abs(other - own) / (DEPTH_TOLERANCE * min(other, own));
            let weight = select(0.0, 1.0, off < 1.0);
            sum += weight * textureLoad(jittered, texel, 0);
            total += weight;
        }
    }
    textureStore(scattered, id.xy, sum / total);
}
