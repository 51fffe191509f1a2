// The reduced coefficients of volumes in the cells of a lattice, m^-1.
//! use media
//! use lattice_axes
//! use cell_order

// Whether a cell touches a medium's box at all; most do not, and sampling costs.
fn touches(m: u32, centre: vec3f) -> bool {
    let half = 0.5 * lattice.cell;
    let to = media[m].volume_from_world;
    let across = mat3x3f(to[0].xyz, to[1].xyz, to[2].xyz)
        * mat3x3f(lattice.axis_x, lattice.axis_y, lattice.axis_z);
    let reach = half * (abs(across[0]) + abs(across[1]) + abs(across[2]));
    let inside = medium_coordinates(m, centre);
    return all(inside > -reach) && all(inside < 1.0 + reach);
}

// rgb: scattering of the reduced medium; a: its extinction, the mean of three channels; m^-1.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let n = params.samples;
    var scattering = vec3f(0.0);
    var extinction = vec3f(0.0);
    let centre = world_from_cells(lattice, vec3f(id) + 0.5);
    // Turned cells reach farther along the world's axes.
    let reach = 0.8660254 * lattice.cell;
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_near(node, centre, reach);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped) { continue; }
        let m = visit.medium;
        let count = select(0u, n * n * n, touches(m, centre));
        var density = 0.0;
        for (var s = 0u; s < count; s++) {
            let inside = (vec3f(cell_at_index(vec3u(n), s)) + 0.5) / f32(n);
            density += medium_density(m, world_from_cells(lattice, vec3f(id) + inside));
        }
        // Similarity theory: sigma_s (1 - g), and the absorption as it is.
        density /= f32(n * n * n);
        let scattered = media[m].sigma_t * media[m].albedo;
        scattering += density * scattered * (1.0 - media[m].g);
        extinction += density * (media[m].sigma_t - scattered * media[m].g);
    }
    let cell = cell_in(lattice.count, id);
    cells[cell] = vec4f(scattering, (extinction.r + extinction.g + extinction.b) / 3.0);
}
