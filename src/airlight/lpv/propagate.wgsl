// One propagation step, a cell an invocation (Kaplanyan2010 section 3.3; blockers 3.2, bounces 7).
//! use stencil6
//! use cell_states
//! needs fn stepped(s: Stencil, faces: Faces) -> mat3x4f

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cell = cell_index(id);
    // The light of the cell and of its six neighbours.
    let around = Stencil(state_at(cell), neighbour(id, 0u, false), neighbour(id, 0u, true),
        neighbour(id, 1u, false), neighbour(id, 1u, true), neighbour(id, 2u, false), neighbour(id, 2u, true));
    // What blocks between them.
    let own = Faces(faces[2u * cell], faces[2u * cell + 1u]);
    store_state(cell, stepped(around, own));
}
