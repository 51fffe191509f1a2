//! use lattice_space
//! use lobes

fn emit(world: vec3f, area: vec3f, emission: vec3f) {
    let n = normalize(area);
    let coordinates = warped_surface_coordinates(lattice, world, n) + 0.5 * n;
    add_lobe(coordinates, n, emission * length(area) * 3.14159265);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.surfel_count) {
        return;
    }
    let surfel = surfels[id.x];
    if (all(surfel.emission <= vec3f(0.0)) || all(surfel.area_normal == vec3f(0.0))) {
        return;
    }
    let instance = instances[surfel.instance];
    let world = (instance.world_from_object * vec4f(surfel.position, 1.0)).xyz;
    let area = (instance.normal_from_object * vec4f(surfel.area_normal, 0.0)).xyz;
    emit(world, area, surfel.emission);
    if (surfel.is_two_sided != 0u) {
        emit(world, -area, surfel.emission);
    }
}
