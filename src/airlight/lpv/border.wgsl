// One hop of the larger lattice's light into the cells along the finer lattice's sides.
//! use hops6
//! use lattice
//! use outer_cells
//! use cell_order

const DEPTH = 3u;       // cells from the border that are asked whether light could leave

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
fn entering_share(cell: vec3u, hop: u32) -> f32 {
    let texel = lattice_texel(lattice, vec3i(cell));
    if (hop < 4u) {
        return textureLoad(lattice_visibility_a, texel, 0)[hop];
    }
    return textureLoad(lattice_visibility_b, texel, 0)[hop - 4u];
}

// How open a face is for light that leaves a cell.
fn leaving_share(cell: vec3u, hop: u32) -> f32 {
    let index = cell_in(lattice.count, cell);
    return 1.0 - unpack4x8unorm(faces[2u * index + hop / 4u][hop % 4u]).w;
}

// Bodies stop light with their outside: what the larger lattice mistakes for light inside a wall
// would come out of it. So nothing enters where none could leave.
fn open_share(cell: vec3u, side: u32) -> f32 {
    let is_high = (side & 1u) == 1u;
    var open = entering_share(cell, side);
    var inner = cell;
    for (var k = 0u; k < DEPTH; k++) {
        open *= leaving_share(inner, side ^ 1u);
        inner[side / 2u] = select(inner[side / 2u] + 1u, inner[side / 2u] - 1u, is_high);
    }
    return open;
}

// What the face neighbour outside hands on in one step, in fixed point.
fn add_entering(index: u32, hop: u32, state: vec4f, open: f32) {
    let units = vec4i(round(received(state, hop) * (open * params.units)));
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
    // The centre of the cell just outside, in the larger lattice; both have the same axes.
    var outside = unwarped_coordinates(lattice, cell, vec3f(0.5));
    outside[axis] += select(-1.0, 1.0, is_high);
    let coordinates = (lattice.origin + outside * lattice.cell - outer.origin) / outer.cell;
    if (any(coordinates < vec3f(0.0)) || any(coordinates > vec3f(outer.count))) {
        return;
    }
    // As far as walls are open to what it sends, channel by channel.
    let open = open_share(cell, id.z);
    if (open <= 0.0) {
        return;
    }
    let uvw = lattice_uvw(outer, outer_place(coordinates));
    let n = lattice.count;
    let first = cell_in(n, cell);
    let cells = n.x * n.y * n.z;
    add_entering(first, id.z, textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0), open);
    add_entering(first + cells, id.z, textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0),
        open);
    add_entering(first + 2u * cells, id.z,
        textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0), open);
}
