// The corner of a lattice around which a surfel counts: the nearest. The including pass binds `lattice`.
//! use cell_order
//! use lattice_axes

const NO_CORNER = 0xffffffffu;
// Cells: how far before a surface its nearest corner is looked for. Walls half way between two corners are common, and
// rounding must not choose. What ends at such a wall reaches no farther than the corners before it.
const BEFORE_TIES = 1e-3;

struct NearestCorner {
    index: u32,             // of all corners, or NO_CORNER
    offset: vec3f,          // cells from there to the point
}

// Of a world point, m, of a surface whose normal is n along the lattice's axes; none more than half a cell beside the
// lattice.
fn nearest_corner(world: vec3f, n: vec3f) -> NearestCorner {
    let coordinates = cells_from_world(lattice, world);
    let corner = vec3i(floor(coordinates + BEFORE_TIES * n + 0.5));
    if (any(corner < vec3i(0)) || any(corner > vec3i(lattice.count))) {
        return NearestCorner(NO_CORNER, vec3f(0.0));
    }
    return NearestCorner(cell_in(lattice.count + 1u, vec3u(corner)), coordinates - vec3f(corner));
}
