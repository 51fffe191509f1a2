//! use medium_grid
//! use open_line

// Places in a block, in its rms radii: corners of a tetrahedron.
const PLACES = array<vec3f, 4>(
    vec3f(0.577, 0.577, 0.577), vec3f(-0.577, -0.577, 0.577), vec3f(-0.577, 0.577, -0.577),
    vec3f(0.577, -0.577, -0.577),
);

fn place_of(point: vec3f) -> vec3f {
    return warped_coordinates(lattice, (walls.world_from_medium * vec4f(point, 1.0)).xyz);
}

// How much of a block of another medium a cell sees past walls.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= walls.blocks || reach[id.x] == 0u) {
        return;
    }
    let block = ordinates[params.ordinate_count - walls.blocks + id.y].position.xyz;
    let radius = sqrt(blocks[5u * id.y].a);
    let end = place_of(cell_centre(cell_of(id.x)));
    var share = 0.0;
    for (var k = 0u; k < 4u; k++) {
        share += open_line(place_of(block + radius * PLACES[k]), end);
    }
    seen[id.y * params.cells + id.x] = 0.25 * share;
}
