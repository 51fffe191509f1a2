// What glossy pixels mirror, followed along its rays and added to the rest of their light, which
// lighting has listed with them, and with the share of it that counts. Their order differs from run to run, they do not.
//! use pixel_point
//! use mirrored_light
//! use packed_pixel

fn first_lattices() -> LatticeParams {
    return lattices[0];
}

fn add_mirrored(pixel: vec2u, rest: vec3f, rest_indirect: vec3f, share: f32) {
    // The surface that the pixel sees, as lighting reads it.
    let position = vec2f(pixel) + 0.5;
    let d = textureLoad(depth, pixel, 0);
    let p = pixel_point(position, d);
    let v = normalize(params.eye - p);
    let base = textureLoad(albedo, pixel, 0);
    let normal_roughness = textureLoad(normal, pixel, 0);
    let n = normalize(normal_roughness.xyz);
    let r = reflector(base.rgb, base.a, normal_roughness.w, textureLoad(emission, pixel, 0).a);
    let n_v = max(dot(n, v), 1e-4);
    let gain = share * specular_albedo(r, n_v) / PI;
    // What comes along the mirrored ray, lattice by lattice from the finest outwards, times the specular albedo over
    // pi.
    let n_own = lattice_from_world(lattice_of(0u), n);
    let mirrored = lattice_from_world(lattice_of(0u), reflect(-v, n));
    var direct = rest;
    var indirect = rest_indirect;
    var at = lattice_step(0u, 1.0, p);
    loop {
        let light = mirrored_light(at.k, p, r, n_v, n_own, vec3f(0.0), mirrored);
        direct += at.weight * gain * light.sky;
        indirect += at.weight * gain * light.indirect;
        if (at.is_last) {
            break;
        }
        at = lattice_step(at.k + 1u, at.left, p);
    }
    textureStore(direct_light, pixel, vec4f(direct, 1.0));
    textureStore(indirect_light, pixel, vec4f(indirect, 1.0));
}

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u,
) {
    let count = found[0];
    var i = id.x;
    if (i >= count) {
        return;
    }
    // As many invocations as fill the device share the list.
    loop {
        let direct = listed[2u * i];
        let indirect = listed[2u * i + 1u];
        let pixel = unpacked_pixel(direct.w);
        add_mirrored(pixel, bitcast<vec3f>(direct.xyz), bitcast<vec3f>(indirect.xyz),
            bitcast<f32>(indirect.w));
        i += groups.x * WX;
        if (i >= count) { break; }
    }
}
