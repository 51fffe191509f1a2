// A cell's mean scattering and extinction, m^-1, over samples^3 points of it.
//! use media
//! use lattice_axes
//! use cell_order

const CELL_RADIUS = 0.8660255;     // cells: half a cell's diagonal

// The density of medium m, summed over n^3 points of a cell.
fn density_of_points(m: u32, cell: vec3u, n: u32) -> f32 {
    // Coordinates in the medium's box are linear in those of the cell.
    let low = world_from_cells(lattice, vec3f(cell));
    let origin = medium_coordinates(m, low);
    let axes = mat3x3f(
        medium_coordinates(m, world_from_cells(lattice, vec3f(cell) + vec3f(1.0, 0.0, 0.0))) - origin,
        medium_coordinates(m, world_from_cells(lattice, vec3f(cell) + vec3f(0.0, 1.0, 0.0))) - origin,
        medium_coordinates(m, world_from_cells(lattice, vec3f(cell) + vec3f(0.0, 0.0, 1.0))) - origin);
    var sum = 0.0;
    for (var k = 0u; k < n * n * n; k++) {
        let inside = (vec3f(cell_at_index(vec3u(n), k)) + 0.5) / f32(n);
        sum += medium_density_at(m, origin + axes * inside);
    }
    return sum;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let n = params.samples;
    var scattering = vec3f(0.0);
    var extinction = vec3f(0.0);
    // Each medium that the cell may meet, at all points of the cell; the tree is walked once.
    let centre = world_from_cells(lattice, vec3f(id) + 0.5);
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_near(node, centre, CELL_RADIUS * lattice.cell);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped) { continue; }
        let density = density_of_points(visit.medium, id, n);
        let found = density * row_of_media(visit.medium).sigma_t;
        extinction += found;
        scattering += found * row_of_media(visit.medium).albedo;
    }
    // Their mean, for each channel apart.
    let share = 1.0 / f32(n * n * n);
    let cells_in_all = lattice.count.x * lattice.count.y * lattice.count.z;
    let cell = cell_in(lattice.count, id);
    for (var channel = 0u; channel < 3u; channel++) {
        medium[channel * cells_in_all + cell] = share
            * vec2f(scattering[channel], extinction[channel]);
    }
}
