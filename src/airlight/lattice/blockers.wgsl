// Surfels of the meshes, summed around the corners of the lattice: how much of a cell face each side of each
// axis covers (Kaplanyan2010 section 3.2).
//! use blocker_side
//! use lattice_axes
//! use nearest_corner

// Rooms let nothing through: where their walls meet, the faces that they cover in part are closed, too.
const SEALED_GAIN = 4.0;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.surfel_count) {
        return;
    }
    let surfel = surfels[id.x];
    let instance = instances[surfel.instance];
    let world = (instance.world_from_object * vec4f(surfel.position, 1.0)).xyz;
    // The cofactor matrix takes area vectors to area vectors.
    let area = lattice_from_world(lattice,
        (instance.normal_from_object * vec4f(surfel.area_normal, 0.0)).xyz);
    // The corner nearest to it.
    let corner = nearest_corner(world, area / max(length(area), 1e-30));
    if (corner.index == NO_CORNER) {
        return;
    }
    let first = CORNER_VALUES * corner.index;
    // Its area across each axis, on the side that it faces, or on both.
    let gain = select(1.0, SEALED_GAIN, surfel.is_sealing != 0u);
    let covered = area * (gain * params.units / (lattice.cell * lattice.cell));
    for (var axis = 0u; axis < 3u; axis++) {
        let units = i32(round(abs(covered[axis])));
        if (units == 0) {
            continue;
        }
        let side = 2u * axis + select(1u, 0u, covered[axis] > 0.0);
        add_side(first, side, units, corner.offset[axis], surfel.reflectance);
        if (surfel.is_two_sided != 0u) {
            add_side(first, side ^ 1u, units, corner.offset[axis], surfel.reflectance);
        }
        add_axis(first, axis, units, corner.offset[axis]);
    }
    let size = length(covered);
    add_oblique(first, covered / max(size, 1e-30), size / gain, corner.offset);
}
