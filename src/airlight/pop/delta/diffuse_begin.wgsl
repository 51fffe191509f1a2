// The start of conjugate gradients: phi = 0, r = b, z = r/diagonal; sums r.z.
//! use diffusion
//! use partial_sums

// The reflectance of the surface before a face.
fn reflectance_before(index: u32, axis: u32, side: u32) -> f32 {
    return wall_reflectance(u32(links[(1u + axis) * params.cells + index].w), 0u, side);
}

// The right-hand side b: P/V less the divergence of the flux that the deposits carry.
fn source(index: u32) -> vec3f {
    let cell = cell_of(index);
    let volume = params.cell.x * params.cell.y * params.cell.z;
    // Through each face: half of both cells' net power, or what leaves the box or meets a surface.
    let d = diffusivity(index);
    let faces = u32(links[index].w);
    var total = deposits[index].xyz;
    for (var face = 0u; face < 6u; face++) {
        let axis = face / 2u;
        let side = face & 1u;
        let outwards = select(-1.0, 1.0, side == 1u);
        let h = params.cell[axis];
        let section = (1u + axis) * params.cells;
        let own = outwards * deposits[section + index].xyz;
        if (is_closed(faces, cell, axis, side)) {
            total -= outer_flux(d, vec3f(0.0), own, h, reflectance_before(index, axis, side)) / h;
        } else {
            let other = beside(index, axis, side);
            let carried = 0.5 * (own + outwards * deposits[section + other].xyz);
            total -= inner_flux(d, diffusivity(other), vec3f(0.0), carried, h) / h;
        }
    }
    return total / volume;
}

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    // The diagonal is the preconditioner.
    var product = vec3f(0.0);
    if (id.x < params.cells) {
        let b = source(id.x);
        let scaled = b / links[id.x].xyz;
        residual[id.x] = vec4f(b, 0.0);
        z[id.x] = vec4f(scaled, 0.0);
        phi[id.x] = vec4f(0.0);
        product = b * scaled;
    }
    leave_sum(RZ, group.x, lane, product);
}
