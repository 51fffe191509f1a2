// One step, a cell and channel per invocation. Cells beyond the lattice hold no light.

fn at_neighbour(at: vec3i, channel: u32) -> vec4f {
    if (any(at < vec3i(0)) || any(at >= vec3i(params.count))) {
        return vec4f(0.0);
    }
    let n = params.count;
    let p = vec3u(at);
    return before[((channel * n.z + p.z) * n.y + p.y) * n.x + p.x]
        * coefficients[params.row + channel].gain;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let channel = id.z / n.z;
    if (id.x >= n.x || id.y >= n.y || channel >= 3u) {
        return;
    }
    let at = vec3u(id.xy, id.z % n.z);
    let cell = (at.z * n.y + at.y) * n.x + at.x;
    let index = channel * n.x * n.y * n.z + cell;
    after[index] = source[index]
        + stepped(coefficients[params.row + channel], vec3i(at), channel, cell, index);
}
