// Adding lobes to a lattice's fixed-point sums. The including pass binds the uniforms `lobes`
// (LobeParams) and `lattice`, and `sums`.
//! use channel_cells

// The narrow lobe would send negative power backwards, where the surface itself is;
// what goes forward is scaled to the whole power.
fn forward_gain(n: vec3f, sharpness: f32) -> f32 {
    let along = lobes.hop_directional * sharpness * n;
    let base = vec3f(lobes.hop_constant);
    let forward = dot(max(base + along, vec3f(0.0)) + max(base - along, vec3f(0.0)), vec3f(1.0));
    return select(1.0, 1.0 / forward, lobes.is_shaped != 0u);
}

fn add_coefficients(index: u32, value: vec4f) {
    let units = vec4i(round(value * lobes.scale));
    if (units.x != 0) { atomicAdd(&sums[index], units.x); }
    if (units.y != 0) { atomicAdd(&sums[index + 1u], units.y); }
    if (units.z != 0) { atomicAdd(&sums[index + 2u], units.z); }
    if (units.w != 0) { atomicAdd(&sums[index + 3u], units.w); }
}

// The sharpest lobe along n that sends nothing negative on a hop, for cells behind which a surface does not block that.
fn free_sharpness(n: vec3f) -> f32 {
    let along = max(abs(n.x), max(abs(n.y), abs(n.z)));
    let free = lobes.hop_constant / max(lobes.hop_directional * along, 1e-6);
    return min(lobes.lobe, select(lobes.free, free, lobes.is_shaped != 0u));
}

// A lobe of `power` (W, rgb) along n into the cell at lattice coordinates.
fn add_lobe(coordinates: vec3f, n: vec3f, power: vec3f) {
    add_sharp_lobe(coordinates, n, lobes.lobe, power);
}

// The same of another sharpness, b over P n / 4pi.
fn add_sharp_lobe(coordinates: vec3f, n: vec3f, sharpness: f32, power: vec3f) {
    let cell = vec3i(floor(coordinates));
    if (any(cell < vec3i(0)) || any(cell >= vec3i(lattice.count))) {
        return;
    }
    let lobe = vec4f(1.0, sharpness * n) * forward_gain(n, sharpness) / 12.566370614;
    let c = vec3u(cell);
    for (var channel = 0u; channel < 3u; channel++) {
        let index = index_in(lattice.count, c, channel);
        add_coefficients(4u * index, power[channel] * lobe);
    }
}
