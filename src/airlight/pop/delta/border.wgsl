// Adds the power that enters the cells at a finer grid's border to what leaves the beams in them.
//! use outer_solution

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // Power, W: the flux that enters through each face times its area.
    let volume = params.cell.x * params.cell.y * params.cell.z;
    var power = vec3f(0.0);
    for (var face = 0u; face < 6u; face++) {
        let axis = face / 2u;
        power += entering_flux(id.x, axis, face & 1u) * volume / params.cell[axis];
    }
    deposits[id.x] += vec4f(power, 0.0);
}
