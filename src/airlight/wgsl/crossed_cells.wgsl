// Surfels between the middles of cells and of the next along x, y and z. The including pass binds `lattice` and
// `crossed`, atomic, of each cell: a bit for each axis, and one for each hop between the two that a surfel there stops.
//! use cell_order
//! use lattice_axes

// How far a surfel reaches, of the side of a square of its area: disks that far leave no gaps between samples.
const SURFEL_REACH = 1.5;
const FIRST_HOP = 3u;
const MOST_CELLS_REACHED = 2.0;

// A surfel at a point of the world, m, with its area vector along the lattice's axes, m^2.
fn add_crossings(world: vec3f, area: vec3f, is_two_sided: bool) {
    let p = cells_from_world(lattice, world) - 0.5;
    let size = length(area);
    let reach = min(SURFEL_REACH * sqrt(size) / lattice.cell, MOST_CELLS_REACHED);
    let n = area / max(size, 1e-30);
    for (var axis = 0u; axis < 3u; axis++) {
        if (abs(n[axis]) < 1e-3) {
            continue;
        }
        // It stops hops against its normal, or both.
        let stopped = select(select(2u, 1u, n[axis] < 0.0), 3u, is_two_sided);
        let bits = (1u << axis) | (stopped << (FIRST_HOP + 2u * axis));
        // The lines through the middles of cells along the axis that its disk meets, and where.
        let b = (axis + 1u) % 3u;
        let c = (axis + 2u) % 3u;
        let first = vec2f(ceil(p[b] - reach), ceil(p[c] - reach));
        let last = vec2f(floor(p[b] + reach), floor(p[c] + reach));
        for (var u = first.x; u <= last.x; u += 1.0) {
            for (var v = first.y; v <= last.y; v += 1.0) {
                let beside = vec2f(u - p[b], v - p[c]);
                let rise = -dot(beside, vec2f(n[b], n[c])) / n[axis];
                if (dot(beside, beside) + rise * rise <= reach * reach) {
                    var cell = vec3i(0);
                    cell[axis] = i32(floor(p[axis] + rise));
                    cell[b] = i32(u);
                    cell[c] = i32(v);
                    if (all(cell >= vec3i(0)) && all(cell < vec3i(lattice.count))) {
                        atomicOr(&crossed[cell_in(lattice.count, vec3u(cell))], bits);
                    }
                }
            }
        }
    }
}
