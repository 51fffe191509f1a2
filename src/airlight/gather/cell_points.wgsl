// The middles of a lattice's cells as gather points, one after the other in rows of texels.
//! use lattice_space

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let cell = (id.z * lattice.count.y + id.y) * lattice.count.x + id.x;
    let texel = vec2u((params.first + cell) % params.width, (params.first + cell) / params.width);
    textureStore(places, texel, vec4f(unwarped_point(lattice, id, vec3f(0.5)), 1.0));
}
