// The light that rays gathered, on surfaces without mirrored rays of their own. What the coat of a rough
// surface mirrors is taken from all around, as its diffuse part is.
//! use surface_reflection
//! needs fn gathered_irradiance_of(pixel: vec2u) -> vec4f
//! needs fn gathered_sky_of(pixel: vec2u) -> vec4f
//! needs fn is_traced_separately(r: Reflector, n_v: f32) -> bool

fn gathered(position: vec2f, d: f32, p: vec3f, r: Reflector, n: vec3f, v: vec3f) -> Gathered {
    let pixel = vec2u(position);
    let n_v = max(dot(n, v), 1e-4);
    let is_listed = is_traced_separately(r, n_v);
    let mirrors = specular_albedo(r, n_v);
    let share = select(0.0, glossy_share(mirrors, sqrt(r.alpha)), is_listed);
    let matt = ((vec3f(1.0) - mirrors) * r.diffuse + (1.0 - share) * mirrors) / PI;
    return Gathered(matt * gathered_sky_of(pixel).rgb, matt * gathered_irradiance_of(pixel).rgb, share,
        is_listed);
}
