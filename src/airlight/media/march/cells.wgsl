// All that marching asks a cell: how open its faces are, and how far the walls on them lie from them.
//! use lattice_space

const OPEN_FROM = vec4f(0.15);
const OPEN_TO = vec4f(0.5);

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let lattice = lattices[arrayLength(&lattices) - 1u];
    if (any(id >= lattice.count)) {
        return;
    }
    // Walls' shifts on all faces, and their visibility as interpolation weighs it.
    let cell = vec3i(id);
    let texel = lattice_texel(lattice, cell);
    let low = wall_shifts_low(lattice, cell);
    let high = wall_shifts_high(lattice, cell);
    let xy = textureLoad(lattice_visibility_a, texel, 0);
    let z = textureLoad(lattice_visibility_b, texel, 0);
    textureStore(march_cells, id, vec4u(
        pack4x8unorm(smoothstep(OPEN_FROM, OPEN_TO, vec4f(xy.x, xy.z, z.x, 0.0))),
        pack4x8unorm(smoothstep(OPEN_FROM, OPEN_TO, vec4f(xy.y, xy.w, z.y, 0.0))),
        pack4x8snorm(vec4f(low, 0.0)), pack4x8snorm(vec4f(high, 0.0))));
}
