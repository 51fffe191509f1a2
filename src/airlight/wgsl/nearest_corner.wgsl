// The corner of a lattice around which a surfel counts: the nearest. The including pass binds `lattice`.
//! use cell_order
//! use lattice_axes

const NO_CORNER = 0xffffffffu;

struct NearestCorner {
    index: u32,             // of all corners, or NO_CORNER
    offset: vec3f,          // cells from there to the point
}

// Of a point of the world, m; none more than half a cell beside the lattice.
fn nearest_corner(world: vec3f) -> NearestCorner {
    let coordinates = cells_from_world(lattice, world);
    let corner = vec3i(floor(coordinates + 0.5));
    if (any(corner < vec3i(0)) || any(corner > vec3i(lattice.count))) {
        return NearestCorner(NO_CORNER, vec3f(0.0));
    }
    return NearestCorner(cell_in(lattice.count + 1u, vec3u(corner)), coordinates - vec3f(corner));
}
