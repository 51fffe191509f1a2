//! use lattice_space
//! use lobes
//! use light_texel
//! use media_light

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.resolution || id.y >= params.resolution || id.z >= params.layers) {
        return;
    }
    let texel = vec2i(id.xy);
    let power_density = textureLoad(flux, texel, id.z, 0).rgb;
    let d = textureLoad(depth, texel, id.z, 0);
    if (d >= 1.0 || all(power_density <= vec3f(0.0))) {
        return;
    }
    let view = views[id.z];
    let centre = texel_centre(id.xy, params.resolution);
    let p = texel_point(view, centre, d);
    let n = normalize(textureLoad(normal, texel, id.z, 0).xyz);
    let owner = owners[id.z];
    let passed = media_light_transmittance(lights[owner], owner, p);
    let coordinates = warped_surface_coordinates(lattice, p, n) + 0.5 * n;
    add_lobe(coordinates, n, passed * power_density * texel_measure(view, centre, params.resolution));
}
