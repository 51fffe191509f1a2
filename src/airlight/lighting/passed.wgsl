// What passes all layers so far.

override HAS_PASSED: bool = false;

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let share = 1.0 - textureLoad(taken, pixel, 0).rgb;
    // Of what nearer panes let by this one lets by its share.
    if (HAS_PASSED) {
        return vec4f(share * textureLoad(passed, pixel, 0).rgb, 1.0);
    }
    return vec4f(share, 1.0);
}
