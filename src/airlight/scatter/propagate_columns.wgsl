// One step over columns of 2 x 2 cells, marched along z: a layer of 4 x 4 columns is loaded once
// and used for the layer below it, its own and the one above. nx and ny are even.

const SLAB = 8u;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let channel = id.z / params.slabs;
    let x = 2u * id.x;
    let y = 2u * id.y;
    let z_first = (id.z % params.slabs) * SLAB;
    if (channel >= 3u || x >= n.x || y >= n.y || z_first >= n.z) {
        return;
    }
    let c = coefficients[params.row + channel];
    // Columns beyond the border are read at a clamped place and weighted by zero.
    let columns = vec4u(max(x, 1u) - 1u, x, x + 1u, min(x + 2u, n.x - 1u));
    let rows = vec4u(max(y, 1u) - 1u, y, y + 1u, min(y + 2u, n.y - 1u)) * n.x;
    let west = select(0.0, 1.0, x > 0u);
    let east = select(0.0, 1.0, x + 2u < n.x);
    let gain = mat4x4f(c.gain * west, c.gain, c.gain, c.gain * east);
    let along = vec4f(select(0.0, 1.0, y > 0u), 1.0, 1.0, select(0.0, 1.0, y + 2u < n.y));

    let plane = n.x * n.y;
    let first = channel * n.z * plane;
    let z_last = min(z_first + SLAB, n.z);
    let under = select(0.0, 1.0, z_first > 0u);
    var below = loaded(first + (max(z_first, 1u) - 1u) * plane, columns, rows, gain, along * under);
    var here = loaded(first + z_first * plane, columns, rows, gain, along);
    for (var z = z_first; z < z_last; z++) {
        let over = select(0.0, 1.0, z + 1u < n.z);
        let above = loaded(first + min(z + 1u, n.z - 1u) * plane, columns, rows, gain,
            along * over);
        let cell = z * plane + y * n.x + x;
        let index = first + cell;
        after[index] = source[index] + stepped_0(c, below, here, above, channel, cell);
        after[index + 1u] = source[index + 1u]
            + stepped_1(c, below, here, above, channel, cell + 1u);
        after[index + n.x] = source[index + n.x]
            + stepped_2(c, below, here, above, channel, cell + n.x);
        after[index + n.x + 1u] = source[index + n.x + 1u]
            + stepped_3(c, below, here, above, channel, cell + n.x + 1u);
        below = here;
        here = above;
    }
}
