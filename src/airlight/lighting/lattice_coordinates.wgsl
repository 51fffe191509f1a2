// Each pixel's lattice coordinates, and the sky's light on its surface.
//! use pixel_point
//! use image_texel
//! use sky_reflected
//! needs fn is_traced_separately(r: Reflector, n_v: f32) -> bool

struct LatticeCoordinates {
    @location(0) coordinates: vec4f,    // of the textures; red of the sky light that is seen directly
    @location(1) sky: vec4f,            // its green and blue; red and green of the interreflected
    @location(2) returned: f32,         // blue of the interreflected
}

@fragment fn fragment(@builtin(position) position: vec4f) -> LatticeCoordinates {
    let pixel = vec2u(position.xy);
    let d = depth_texel(depth, pixel);
    if (d <= 0.0) {
        return LatticeCoordinates(vec4f(0.0), vec4f(0.0), 0.0);
    }
    let p = pixel_point(position.xy, d);
    let v = normalize(params.eye - p);
    let base = image_texel(albedo, pixel);
    let normal_roughness = image_texel(normal, pixel);
    let n = normalize(normal_roughness.xyz);
    let r = reflector(base.rgb, base.a, normal_roughness.w, image_texel(emission, pixel).a);
    let n_v = max(dot(n, v), 1e-4);
    let lattice = first_lattices();
    let n_own = lattice_from_world(lattice, n);
    let mirrored = lattice_from_world(lattice, reflect(-v, n));
    let uvw = lattice_coordinates(lattice, p, n_own);
    let open = near_field_at(position.xy, 1.0 / (params.world_from_clip[2].w * d)).open;
    let mirrors = select(mirror_gain(r, n_v, open), vec3f(0.0), is_traced_separately(r, n_v));
    let sky = sky_reflected(r, n_v, sky_at(uvw, n_own), sky_at(uvw, mirrored), open, mirrors);
    let weight = lattice_weight(lattice, p);
    let shown = weight * sky.shown;
    let returned = weight * sky.returned;
    return LatticeCoordinates(vec4f(uvw, shown.r), vec4f(shown.gb, returned.rg), returned.b);
}
