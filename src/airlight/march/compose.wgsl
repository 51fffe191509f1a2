struct Composed {
    @location(0) direct: vec4f,
    @location(1) indirect: vec4f,
    @location(2) radiance: vec4f,
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Composed {
    let pixel = vec2i(position.xy);
    let T = vec4f(textureLoad(transmittance, pixel, 0).rgb, 1.0);
    let scattered = textureLoad(single, pixel, 0).rgb + textureLoad(multiple, pixel, 0).rgb;
    var out: Composed;
    out.direct = textureLoad(direct, pixel, 0) * T;
    out.indirect = textureLoad(indirect, pixel, 0) * T;
    out.radiance = vec4f(out.direct.rgb + out.indirect.rgb + scattered, out.direct.a);
    return out;
}
