// What the eye gets of surfaces through media: both layers of their light times the transmittance of its ray.
struct Composed {
    @location(0) direct: vec4f,
    @location(1) indirect: vec4f,
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Composed {
    let pixel = vec2i(position.xy);
    let T = vec4f(textureLoad(transmittance, pixel, 0).rgb, 1.0);
    return Composed(textureLoad(direct, pixel, 0) * T, textureLoad(indirect, pixel, 0) * T);
}
