// One layer of an image under those before it.

override IS_SURFACE: bool = false;  // light of the surface itself, as far as it is there
override IS_MEDIUM: bool = false;   // light of media before it, as far as it covers what comes through them again
override IS_LAST: bool = false;     // all that is behind
override HAS_FRONT: bool = false;
override HAS_PASSED: bool = false;

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let image = textureLoad(light, pixel, 0);
    // How much of the layer is there: the surface's coverage, or per colour what its medium covers.
    var weight = vec3f(1.0);
    if (!IS_LAST) {
        let covered = textureLoad(taken, pixel, 0);
        weight = select(vec3f(select(0.0, covered.a, IS_SURFACE)), covered.rgb, IS_MEDIUM);
    }
    // C = C_front + T_front L.
    if (HAS_PASSED) {
        weight *= textureLoad(passed, pixel, 0).rgb;
    }
    var sum = vec3f(0.0);
    if (HAS_FRONT) {
        sum = textureLoad(front, pixel, 0).rgb;
    }
    return vec4f(sum + select(vec3f(0.0), weight * image.rgb, weight > vec3f(0.0)), image.a);
}
