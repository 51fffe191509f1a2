//! use tone

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let c = textureLoad(picture, vec2i(position.xy), 0).rgb;
    if (params.is_raw == 1u) {
        return vec4f(srgb_encode(finite_or_zero(c)), 1.0);
    }
    let stops = params.exposure + select(0.0, metered[0], params.is_metered == 1u);
    return vec4f(srgb_encode(tone_map(c, stops, params.curve)), 1.0);
}
