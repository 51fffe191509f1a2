// Adds what enters through a finer grid's border to the net flux of the cells there.
//! use outer_solution

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // J at a centre is the mean of both faces'; what enters the lower one goes upwards.
    for (var axis = 0u; axis < 3u; axis++) {
        let j = 0.5 * (entering_flux(id.x, axis, 0u) - entering_flux(id.x, axis, 1u));
        diffuse[(1u + axis) * params.cells + id.x] += vec4f(j, 0.0);
    }
}
