//! use medium_grid

// Diffuse light that arrives in the middle of a cell, travelling towards the eye; see arriving in
// maths/outgoing_light.py. The including pass binds `params` (MediumParams) and `diffuse`, of which
// pop/delta/outgoing.wgsl fills the last sections.

const LEAST_TRANSMITTANCE = 0.005;

fn arriving(index: u32, travel: vec3f) -> vec3f {
    let n = params.cells;
    let count = vec3i(params.count);
    let step = min(params.cell.x, min(params.cell.y, params.cell.z));
    // Half a step in the cell itself.
    var through = exp(-0.5 * step * diffuse[5u * n + index].xyz);
    var light = diffuse[4u * n + index].xyz * (1.0 - through);
    // Then steps on, away from the eye, as far as the grid goes.
    let middle = vec3f(cell_of(index)) + 0.5;
    let stride = travel * step / params.cell;
    let most = u32(ceil(length(vec3f(params.count) * params.cell) / step));
    for (var i = 1u; i <= most && max(through.r, max(through.g, through.b)) > LEAST_TRANSMITTANCE; i++) {
        let at = vec3i(floor(middle - stride * f32(i)));
        if (any(at < vec3i(0)) || any(at >= count)) {
            break;
        }
        let other = u32(at.x + count.x * (at.y + count.y * at.z));
        let passed = exp(-step * diffuse[5u * n + other].xyz);
        light += through * diffuse[4u * n + other].xyz * (1.0 - passed);
        through *= passed;
    }
    return light;
}
