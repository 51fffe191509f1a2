// Between the world and a lattice's own axes. The including pass declares the struct LatticeParams.
// Positions, normals and directions of light are along a lattice's axes wherever its cells are asked:
// propagation, blockers and lookups know no other.

// A vector of the world, or a point (m), along the lattice's axes.
fn lattice_from_world(lattice: LatticeParams, v: vec3f) -> vec3f {
    return vec3f(dot(lattice.axis_x, v), dot(lattice.axis_y, v), dot(lattice.axis_z, v));
}

// The inverse.
fn world_from_lattice(lattice: LatticeParams, v: vec3f) -> vec3f {
    return v.x * lattice.axis_x + v.y * lattice.axis_y + v.z * lattice.axis_z;
}

// Cells from the lattice's first corner to a point of the world, m.
fn cells_from_world(lattice: LatticeParams, world: vec3f) -> vec3f {
    return (lattice_from_world(lattice, world) - lattice.origin) / lattice.cell;
}

// The inverse.
fn world_from_cells(lattice: LatticeParams, coordinates: vec3f) -> vec3f {
    return world_from_lattice(lattice, lattice.origin + coordinates * lattice.cell);
}
