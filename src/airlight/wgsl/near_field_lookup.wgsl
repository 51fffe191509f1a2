//! use near_field_texel

// What stands nearer than cells resolve, read at full size. The including pass binds `near_field` and
// `params` with the image's `size`, and has the override HAS_OCCLUSION.

// Occlusion of depths farther off than this share does not count.
const OCCLUSION_DEPTH_TOLERANCE = 0.05;

// Bilinear among texels of about the pixel's own depth (m along the view axis). Source: Kopf2007
// (joint bilateral upsampling).
fn near_field_at(position: vec2f, own: f32) -> NearField {
    if (!HAS_OCCLUSION) {
        return NearField(1.0, vec3f(0.0), vec3f(0.0), 0.0);
    }
    let size = vec2f(textureDimensions(near_field));
    // A texel is the mean of 4 x 4 from the one before it, so its middle is half a texel farther.
    let at = position * size / params.size - 1.0;
    let base = floor(at);
    let t = at - base;
    var light = vec3f(0.0);
    var direction = vec4f(0.0);
    var open = 0.0;
    var total = 0.0;
    var k = 0u;
    loop {
        let corner = vec2f(f32(k & 1u), f32(k >> 1u));
        let texel = vec2i(clamp(base + corner, vec2f(0.0), size - 1.0));
        let packed = textureLoad(near_field, texel, 0);
        let near = near_field_of(packed);
        // Bilinear weights, which fall by the fourth power of the difference in depth.
        let share = mix(1.0 - t, t, corner);
        let off = abs(bitcast<f32>(packed.w) - own) / (OCCLUSION_DEPTH_TOLERANCE * own);
        let weight = (share.x * share.y + 0.02) / (1.0 + off * off * off * off) + 1e-9;
        light += weight * near.light;
        direction += weight * vec4f(near.direction, near.hidden);
        open += weight * near.open;
        total += weight;
        k++;
        if (k > 3u) { break; }
    }
    return NearField(open / total, light / total, direction.xyz / total, direction.w / total);
}
