// Where each pixel's surface looks the lattice's light up, and the sky's light on it.
//! use pixel_point
//! use image_texel
//! use sky_reflected

struct Places {
    @location(0) place: vec4f,      // texture coordinates; red of what is shown
    @location(1) sky: vec4f,        // green and blue of that; red and green of what is returned
    @location(2) returned: f32,     // blue of that
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Places {
    let pixel = vec2u(position.xy);
    let d = depth_texel(depth, pixel);
    if (d <= 0.0) {
        return Places(vec4f(0.0), vec4f(0.0), 0.0);
    }
    let p = pixel_point(position.xy, d);
    let v = normalize(params.eye - p);
    let base = image_texel(albedo, pixel);
    let bent = image_texel(normal, pixel);
    let n = normalize(bent.xyz);
    let r = reflector(base.rgb, base.a, bent.w, image_texel(emission, pixel).a);
    let n_v = max(dot(n, v), 1e-4);
    let lattice = first_lattices();
    let uvw = lattice_coordinates(lattice, p, n);
    let open = near_surroundings(position.xy, 1.0 / (params.world_from_clip[2].w * d)).open;
    let mirrors = select(mirror_gain(r, n_v, open), vec3f(0.0), is_walked_apart(r, n_v));
    let sky = sky_reflected(r, n_v, sky_at(uvw, n), sky_at(uvw, reflect(-v, n)), open, mirrors);
    let weight = lattice_weight(lattice, p);
    let shown = weight * sky.shown;
    let returned = weight * sky.returned;
    return Places(vec4f(uvw, shown.r), vec4f(shown.gb, returned.rg), returned.b);
}
