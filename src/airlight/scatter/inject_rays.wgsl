// Points of the ray from a light to what a texel of its map sees: what media scatter there enters cells
// (Billeter2012 section 4.1).
//! use lattice_space
//! use lobes
//! use light_texel
//! use media_light
//! use sampling
//! use lights

// What the light sends along the texel's ray: W per metre squared (parallel) or per steradian of its measure.
fn sent(light: LightData, direction: vec3f) -> vec3f {
    return light.color * select(1.0, sent_share(light, direction), sends_by_direction(light.kind));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.resolution || id.y >= params.resolution || id.z >= params.layers) {
        return;
    }
    let view = row_of_views(id.z);
    let owner = owners[id.z];
    let light = row_of_lights(owner);
    let centre = texel_centre(id.xy, params.resolution);
    let hit = texel_point(view, centre, textureLoad(depth, vec2i(id.xy), id.z, 0));
    // From the light itself, or from the near plane, which lies before everything.
    var start = texel_point(view, centre, 0.0);
    if (view.is_perspective != 0u) {
        start = light.position;
    }
    // The flux of the texel's beam.
    let reach = length(hit - start);
    let direction = (hit - start) / max(reach, 1e-12);
    let power = sent(light, direction) * texel_measure(view, centre, params.resolution);
    // The stretch of it in the lattice, up to the surface; a ray that hits nothing goes on.
    let low = lattice.origin;
    let span = ray_box_interval(lattice_from_world(lattice, start), lattice_from_world(lattice, direction),
        low, low + lattice.cell * vec3f(lattice.count));
    let t0 = max(0.0, span.x);
    let stretch = min(span.y, select(MEDIUM_FAR, reach, textureLoad(depth, vec2i(id.xy), id.z, 0)
        < 1.0)) - t0;
    if (stretch <= 0.0 || all(power <= vec3f(0.0))) {
        return;
    }
    // Random points, the same in every frame, each of which stands for an equal part of the stretch.
    let count = f32(params.samples);
    var hash = pcg_hash(pcg_hash((id.z * params.resolution + id.y) * params.resolution + id.x)
        ^ params.seed);
    for (var i = 0u; i < params.samples; i++) {
        hash = pcg_hash(hash + i);
        let u = uniform_from_hash(hash);
        let share = select(u, (f32(i) + u) / count, params.is_stratified != 0u);
        let p = start + (t0 + share * stretch) * direction;
        let gained = media_coefficients(p).scattering * media_light_transmittance(light, owner, p);
        add_lobe(warped_coordinates(lattice, p), vec3f(0.0), power * gained * (stretch / count));
    }
}
