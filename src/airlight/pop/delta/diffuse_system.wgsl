// The operator of the diffusion solve: its diagonal, and the links to the next cells along x, y, z. Behind them: which
// faces are closed, and the reflectances of those across each axis.
//! use diffusion

// The flux per difference of phi across a cell's upper inner face, over its side h, m^-1; 0 on the
// upper faces of the box and where surfaces stand.
fn link_up(index: u32, cell: vec3u, axis: u32, faces: u32) -> vec3f {
    if (is_closed(faces, cell, axis, 1u)) {
        return vec3f(0.0);
    }
    let h = params.cell[axis];
    let other = diffusivity(beside(index, axis, 1u));
    return inner_flux(diffusivity(index), other, vec3f(1.0), vec3f(0.0), h) / h;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    let cell = cell_of(id.x);
    // Which of the six faces surfaces close, and what those reflect (wgsl/walls.wgsl).
    let faces = walls[2u * id.x] & 63u;
    let reflecting = walls[2u * id.x + 1u];
    // The diagonal carries the closed faces in its w, each link the reflectances across its axis.
    links[id.x] = vec4f(diffusion_diagonal(id.x, faces, reflecting), f32(faces));
    for (var axis = 0u; axis < 3u; axis++) {
        links[(1u + axis) * params.cells + id.x] = vec4f(link_up(id.x, cell, axis, faces),
            f32((reflecting >> (2u * REFLECTING_BITS * axis)) & 1023u));
    }
}
