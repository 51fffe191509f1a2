//! use lattice

// One hop of the larger lattice's light into the cells along the finer lattice's sides.

// The cell at (u, v) of side 0..5 (x low, x high, y low ...).
fn side_cell(u: u32, v: u32, axis: u32, is_high: bool) -> vec3u {
    var cell = vec3u(u, v, v);
    if (axis == 0u) { cell = vec3u(0u, u, v); }
    if (axis == 1u) { cell = vec3u(u, 0u, v); }
    if (axis == 2u) { cell = vec3u(u, v, 0u); }
    cell[axis] = select(0u, lattice.count[axis] - 1u, is_high);
    return cell;
}

// Through a low side light goes along the positive axis: side and hop have the same number.
fn side_openness(cell: vec3u, hop: u32) -> f32 {
    let texel = lattice_texel(lattice, vec3i(cell));
    if (hop < 4u) {
        return textureLoad(lattice_open_a, texel, 0)[hop];
    }
    return textureLoad(lattice_open_b, texel, 0)[hop - 4u];
}

fn add_entering(index: u32, hop: u32, state: vec4f, open: f32) {
    var matrices = HOPS;
    let units = vec4i(round(matrices[hop] * state * (open * params.units)));
    for (var k = 0u; k < 4u; k++) {
        if (units[k] != 0) { atomicAdd(&sums[4u * index + k], units[k]); }
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let axis = id.z / 2u;
    let is_high = (id.z & 1u) == 1u;
    let cell = side_cell(id.x, id.y, axis, is_high);
    if (id.z >= 6u || any(cell >= lattice.count)) {
        return;
    }
    var world = unbent_point(lattice, cell, vec3f(0.5));
    world[axis] += select(-lattice.cell, lattice.cell, is_high);
    let place = (world - outer.origin) / outer.cell;
    if (any(place < vec3f(0.0)) || any(place > vec3f(outer.count))) {
        return;
    }
    let open = side_openness(cell, id.z);
    if (open <= 0.0) {
        return;
    }
    let uvw = lattice_eased(outer, bent_place(outer, world));
    let n = lattice.count;
    let first = (cell.z * n.y + cell.y) * n.x + cell.x;
    let cells = n.x * n.y * n.z;
    add_entering(first, id.z, textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0), open);
    add_entering(first + cells, id.z, textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0),
        open);
    add_entering(first + 2u * cells, id.z,
        textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0), open);
}
