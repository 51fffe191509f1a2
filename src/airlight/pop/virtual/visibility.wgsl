// Visibility of a virtual point light from a cell, by the lattice.
//! use medium_grid
//! use open_line

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= virtual_lights.count || reach[id.x] == 0u) {
        return;
    }
    let row = virtual_lights.first_row + id.y;
    // A straight line through the lattice, to half a cell before the light's surface.
    let centre = cell_centre(cell_of(id.x));
    let world = (params.world_from_medium * vec4f(centre, 1.0)).xyz;
    let share = open_line(warped_coordinates(lattice, world), light_cells[id.y].xyz);
    passed[(params.ordinate_count + row) * params.cells + id.x] = share;
}
