//! use occlusion

// Ambient occlusion read at full size. The including pass binds `occlusion` and `params` with the
// picture's `size`, and sets the override HAS_OCCLUSION.

// Occlusion of depths farther off than this share does not count.
const OCCLUSION_DEPTH_TOLERANCE = 0.05;

// How open the near surroundings are: bilinear among texels of about the pixel's own depth (m
// along the view axis). Source: Kopf et al. 2007 (joint bilateral upsampling).
fn near_visibility(position: vec2f, own: f32) -> f32 {
    if (!HAS_OCCLUSION) {
        return 1.0;
    }
    let size = vec2f(textureDimensions(occlusion));
    // A texel is the mean of 4 x 4 from the one before it, so its middle is half a texel farther.
    let place = position * size / params.size - 1.0;
    let base = floor(place);
    let t = place - base;
    var sum = 0.0;
    var total = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let corner = vec2f(f32(k & 1u), f32(k >> 1u));
        let texel = textureLoad(occlusion, vec2i(clamp(base + corner, vec2f(0.0), size - 1.0)), 0);
        let share = mix(1.0 - t, t, corner);
        let off = abs(texel.y - own) / (OCCLUSION_DEPTH_TOLERANCE * own);
        let weight = (share.x * share.y + 0.02) / (1.0 + off * off * off * off) + 1e-9;
        sum += weight * texel.x;
        total += weight;
    }
    return sum / total;
}
