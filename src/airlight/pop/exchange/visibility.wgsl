// The share of a block of another medium that a cell sees past surfaces: the mean of four samples.
//! use medium_grid
//! use open_line

// Offsets of the samples in a block, in its rms radii: corners of a tetrahedron.
const OFFSETS = array<vec3f, 4>(
    vec3f(0.577, 0.577, 0.577), vec3f(-0.577, -0.577, 0.577), vec3f(-0.577, 0.577, -0.577),
    vec3f(0.577, -0.577, -0.577),
);

// Lattice coordinates of a point in the medium's frame.
fn lattice_place(point: vec3f) -> vec3f {
    return warped_coordinates(lattice, (params.world_from_medium * vec4f(point, 1.0)).xyz);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= exchange.blocks || reach[id.x] == 0u) {
        return;
    }
    // Straight lines through the faces of the lattice, from four samples of the block.
    let block = ordinates[params.ordinate_count - exchange.blocks + id.y].position.xyz;
    let radius = sqrt(blocks[5u * id.y].a);
    let end = lattice_place(cell_centre(cell_of(id.x)));
    var share = 0.0;
    for (var k = 0u; k < 4u; k++) {
        share += open_line(lattice_place(block + radius * OFFSETS[k]), end);
    }
    seen[id.y * params.cells + id.x] = 0.25 * share;
}
