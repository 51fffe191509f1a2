// Point lights without shadow maps, each into its cell.
//! use lattice_space
//! use lobes

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.lights) {
        return;
    }
    let light = points[id.x];
    // No lobe: the same in all directions.
    add_lobe(warped_coordinates(lattice, light.position), vec3f(0.0), light.intensity * 12.566370614);
}
