// Fluence and net flux of diffuse light in a cell, from the solution phi.
//! use diffusion

// The flux J outwards through a face of a cell, W m^-2.
fn flux_outwards(index: u32, axis: u32, side: u32) -> vec3f {
    let volume = params.cell.x * params.cell.y * params.cell.z;
    let outwards = select(-1.0, 1.0, side == 1u) / volume;
    let h = params.cell[axis];
    let section = (1u + axis) * params.cells;
    let own = outwards * deposits[section + index].xyz;
    let d = diffusivity(index);
    if (is_closed(u32(links[index].w), cell_of(index), axis, side)) {
        let reflectance = wall_reflectance(u32(links[section + index].w), 0u, side);
        return outer_flux(d, phi[index].xyz, own, h, reflectance);
    }
    let other = beside(index, axis, side);
    let carried = 0.5 * (own + outwards * deposits[section + other].xyz);
    let step = phi[index].xyz - phi[other].xyz;
    return inner_flux(d, diffusivity(other), step, carried, h);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // The solution may undershoot zero; J at the centre is the mean of two faces.
    diffuse[id.x] = vec4f(max(phi[id.x].xyz, vec3f(0.0)), 0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        let j = 0.5 * (flux_outwards(id.x, axis, 1u) - flux_outwards(id.x, axis, 0u));
        diffuse[(1u + axis) * params.cells + id.x] = vec4f(j, 0.0);
    }
}
