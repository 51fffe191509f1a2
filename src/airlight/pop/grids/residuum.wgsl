// A step of isotropic radiance: a sixth of a cell's goes to each of its six neighbours. `diffuse`
// is the sum over all steps, as fluence (Elek2014 section 5.4).
//! use medium_grid

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // What the neighbours send.
    let cell = cell_of(id.x);
    var sum = vec3f(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        let stride = cell_stride(axis);
        if (cell[axis] > 0u) {
            sum += light_in[id.x - stride].xyz;
        }
        if (cell[axis] + 1u < params.count[axis]) {
            sum += light_in[id.x + stride].xyz;
        }
    }
    // What absorption leaves of it.
    let length = (params.cell.x + params.cell.y + params.cell.z) / 3.0;
    let passed = exp(-density[id.x] * params.sigma_t * (1.0 - params.albedo) * length);
    let light = residuum.scale * sum / 6.0 * passed;
    light_out[id.x] = vec4f(light, 0.0);
    // The sum over steps, without a net flux.
    var before = vec3f(0.0);
    if (residuum.step > 0u) {
        before = diffuse[id.x].xyz;
    }
    diffuse[id.x] = vec4f(before + light, 0.0);
    for (var axis = 1u; axis <= 3u; axis++) {
        diffuse[id.x + axis * params.cells] = vec4f(0.0);
    }
}
