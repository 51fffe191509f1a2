// The light that rays gathered, and what smooth surfaces mirror along rays of their own. What the coat of a
// rough surface mirrors is taken from all around, as its diffuse part is.
//! use surface_reflection
//! needs fn gathered_irradiance_of(pixel: vec2u) -> vec4f
//! needs fn gathered_sky_of(pixel: vec2u) -> vec4f
//! needs fn mirrored_light_of(pixel: vec2u) -> vec4f
//! needs fn mirrored_sky_of(pixel: vec2u) -> vec4f

fn gathered(position: vec2f, d: f32, p: vec3f, r: Reflector, n: vec3f, v: vec3f) -> Gathered {
    let pixel = vec2u(position);
    let mirrors = specular_albedo(r, max(dot(n, v), 1e-4));
    let light = mirrored_light_of(pixel);
    let sky = mirrored_sky_of(pixel);
    let share = light.a * glossy_share(mirrors, sqrt(r.alpha));
    let matt = ((vec3f(1.0) - mirrors) * r.diffuse + (1.0 - share) * mirrors) / PI;
    return Gathered(matt * gathered_sky_of(pixel).rgb + share * sky.rgb,
        matt * gathered_irradiance_of(pixel).rgb + share * light.rgb, 1.0, false);
}
