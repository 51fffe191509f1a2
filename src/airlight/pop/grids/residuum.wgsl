//! use medium_grid

// Radiance of the medium's cells hops a sixth each way; `diffuse` sums it up as fluence.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
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
    let length = (params.cell.x + params.cell.y + params.cell.z) / 3.0;
    let passed = exp(-density[id.x] * params.sigma_t * (1.0 - params.albedo) * length);
    let light = isotropic.scale * sum / 6.0 * passed;
    light_out[id.x] = vec4f(light, 0.0);
    var before = vec3f(0.0);
    if (isotropic.step > 0u) {
        before = diffuse[id.x].xyz;
    }
    diffuse[id.x] = vec4f(before + light, 0.0);
    for (var axis = 1u; axis <= 3u; axis++) {
        diffuse[id.x + axis * params.cells] = vec4f(0.0);
    }
}
