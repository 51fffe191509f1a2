//! use medium_grid
//! use walls

// Diffuse light that arrives in the middle of a cell, travelling towards the eye; see arriving in
// maths/outgoing_light.py. The including pass binds `params` (MediumParams) and `diffuse`, of which
// pop/delta/outgoing.wgsl fills the last sections.

const LEAST_TRANSMITTANCE = 0.005;

// Whether a surface stands between a cell and the next one on the path, a step of at most a cell along each axis;
// `faces` and `next_faces`: those of both.
fn is_step_walled(faces: u32, next_faces: u32, step: vec3i) -> bool {
    var walled = false;
    for (var axis = 0u; axis < 3u; axis++) {
        let side = u32(step[axis] > 0);
        walled |= step[axis] != 0 && (is_walled(faces, axis, side) || is_walled(next_faces, axis, 1u - side));
    }
    return walled;
}

fn arriving(index: u32, travel: vec3f) -> vec3f {
    let n = params.cells;
    let count = vec3i(params.count);
    let step = min(params.cell.x, min(params.cell.y, params.cell.z));
    // Half a step in the cell itself.
    let own = diffuse[5u * n + index];
    var faces = u32(own.w);
    var through = exp(-0.5 * step * own.xyz);
    var light = diffuse[4u * n + index].xyz * (1.0 - through);
    // Then steps on, away from the eye, as far as the grid goes and no surface stands.
    var last = vec3i(cell_of(index));
    let middle = vec3f(cell_of(index)) + 0.5;
    let stride = travel * step / params.cell;
    let most = u32(ceil(length(vec3f(params.count) * params.cell) / step));
    for (var i = 1u; i <= most && max(through.r, max(through.g, through.b)) > LEAST_TRANSMITTANCE; i++) {
        let at = vec3i(floor(middle - stride * f32(i)));
        if (any(at < vec3i(0)) || any(at >= count)) {
            break;
        }
        let other = u32(at.x + count.x * (at.y + count.y * at.z));
        let there = diffuse[5u * n + other];
        if (is_step_walled(faces, u32(there.w), at - last)) {
            break;
        }
        faces = u32(there.w);
        last = at;
        let passed = exp(-step * there.xyz);
        light += through * diffuse[4u * n + other].xyz * (1.0 - passed);
        through *= passed;
    }
    return light;
}
