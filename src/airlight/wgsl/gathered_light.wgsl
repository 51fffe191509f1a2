// The light that rays gathered, and on smooth surfaces what lattices mirror. The including pass binds what
// mirrored_light needs.
//! use mirrored_light
//! needs fn gathered_irradiance_of(pixel: vec2u) -> vec4f
//! needs fn gathered_sky_of(pixel: vec2u) -> vec4f

fn gathered(position: vec2f, d: f32, p: vec3f, r: Reflector, n: vec3f, v: vec3f) -> Gathered {
    let pixel = vec2u(position);
    let n_v = max(dot(n, v), 1e-4);
    let mirrors = specular_albedo(r, n_v);
    let share = glossy_share(mirrors, sqrt(r.alpha));
    // What the coat of a rough surface mirrors is taken from all around, as its diffuse part is.
    let matt = ((vec3f(1.0) - mirrors) * r.diffuse + (1.0 - share) * mirrors) / PI;
    var out = Gathered(matt * gathered_sky_of(pixel).rgb, matt * gathered_irradiance_of(pixel).rgb,
        1.0, false);
    if (share <= 0.0) {
        return out;
    }
    let axes = lattice_of(0u);
    let n_own = lattice_from_world(axes, n);
    let mirrored = lattice_from_world(axes, reflect(-v, n));
    let gain = share * mirrors / PI;
    var at = lattice_step(0u, 1.0, p);
    loop {
        let light = mirrored_light(at.k, p, r, n_v, n_own, vec3f(0.0), mirrored);
        out.direct += at.weight * gain * light.sky;
        out.indirect += at.weight * gain * light.indirect;
        if (at.is_last) {
            break;
        }
        at = lattice_step(at.k + 1u, at.left, p);
    }
    return out;
}
