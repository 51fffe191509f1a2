//! use tone

const KIND_NORMAL = 2u;
const KIND_DEPTH = 3u;

fn shown(pixel: vec2i) -> vec3f {
    if (params.kind == KIND_DEPTH) {
        // Reversed and infinite: 1 / (1 + distance / reach), 0 where nothing is.
        let d = textureLoad(depth, pixel, 0);
        return vec3f(select(d / (d + params.depth_at_reach), 0.0, d <= 0.0));
    }
    // A weight of zero must not let a NaN through.
    var sum = vec3f(0.0);
    if (params.weights.x > 0.0) { sum += finite_or_zero(textureLoad(layer0, pixel, 0).rgb); }
    if (params.weights.y > 0.0) { sum += finite_or_zero(textureLoad(layer1, pixel, 0).rgb); }
    if (params.weights.z > 0.0) { sum += finite_or_zero(textureLoad(layer2, pixel, 0).rgb); }
    if (params.weights.w > 0.0) { sum += finite_or_zero(textureLoad(layer3, pixel, 0).rgb); }
    return select(sum, sum * 0.5 + 0.5, params.kind == KIND_NORMAL);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let sample = shown(pixel);
    // The running mean; the first image replaces what was there.
    if (params.weight >= 1.0) {
        return vec4f(sample, 1.0);
    }
    return vec4f(mix(textureLoad(mean, pixel, 0).rgb, sample, params.weight), 1.0);
}
