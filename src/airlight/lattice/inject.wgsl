//! use lattice_space

// A texel's solid angle in perspective, or its area where the light is parallel.
fn texel_measure(view: LightViewData, centre: vec2f) -> f32 {
    let area = view.texel.x * view.texel.y;
    if (view.is_perspective == 0u) {
        return area;
    }
    let tangent = centre * view.texel * f32(params.resolution) * 0.5;
    return area * pow(1.0 + dot(tangent, tangent), -1.5);
}

// The narrow lobe would send negative power backwards, where the surface itself closes the way;
// what goes forward is scaled to the whole power.
fn forward_gain(n: vec3f) -> f32 {
    let along = params.hop_direct * params.lobe * n;
    let base = vec3f(params.hop_even);
    let forward = dot(max(base + along, vec3f(0.0)) + max(base - along, vec3f(0.0)), vec3f(1.0));
    return select(1.0, 1.0 / forward, params.is_shaped != 0u);
}

fn add(index: u32, value: vec4f) {
    let units = vec4i(round(value * params.scale));
    if (units.x != 0) { atomicAdd(&sums[index], units.x); }
    if (units.y != 0) { atomicAdd(&sums[index + 1u], units.y); }
    if (units.z != 0) { atomicAdd(&sums[index + 2u], units.z); }
    if (units.w != 0) { atomicAdd(&sums[index + 3u], units.w); }
}

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
    let centre = (vec2f(id.xy) + 0.5) / f32(params.resolution) * vec2f(2.0, -2.0)
        + vec2f(-1.0, 1.0);
    let world = view.world_from_clip * vec4f(centre, d, 1.0);
    let n = normalize(textureLoad(normal, texel, id.z, 0).xyz);
    let place = bent_place(lattice, world.xyz / world.w) + 0.5 * n;
    let cell = vec3i(floor(place));
    if (any(cell < vec3i(0)) || any(cell >= vec3i(lattice.count))) {
        return;
    }
    let power = power_density * texel_measure(view, centre) / 12.566370614;
    let lobe = vec4f(1.0, params.lobe * n) * forward_gain(n);
    let c = vec3u(cell);
    for (var channel = 0u; channel < 3u; channel++) {
        let index = ((channel * lattice.count.z + c.z) * lattice.count.y + c.y) * lattice.count.x
            + c.x;
        add(4u * index, power[channel] * lobe);
    }
}
