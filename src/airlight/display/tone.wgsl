//! use tone
//! use sampling

// As maths.tone.dither_codes: less than a code, so that rounding errors leave whole codes alone.
const DITHER_CODES = 0.98;

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let c = textureLoad(image, vec2i(position.xy), 0).rgb;
    // Values of raw layers are encoded as they are.
    if (params.is_raw == 1u) {
        return vec4f(srgb_encode(finite_or_zero(c)), 1.0);
    }
    // Exposed, through the curve and sRGB, with dither of less than a code.
    let stops = params.exposure + select(0.0, metered[0], params.is_metered == 1u);
    let noise = r2_noise(u32(position.x), u32(position.y), 0u) - 0.5;
    return vec4f(srgb_encode(tone_map(c, stops, params.curve)) + DITHER_CODES / 255.0 * noise, 1.0);
}
