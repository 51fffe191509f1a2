// One step among walls over rows of four cells a lane, marched along z: a layer of three rows is
// loaded once, two cells at a time, and used for the layer below it, its own and the one above.
// What stands beside a lane's cells comes from the lanes beside it. nx is even.

const SLAB = 8u;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let channel = id.z / params.slabs;
    let x = WIDTH * id.x;
    let y = id.y;
    let z_first = (id.z % params.slabs) * SLAB;
    if (channel >= 3u || x >= n.x || y >= n.y || z_first >= n.z) {
        return;
    }
    let c = coefficients[params.row + channel];
    let at = vec2u(x, y);
    let plane = n.x * n.y;
    let first = channel * n.z * plane;
    let z_last = min(z_first + SLAB, n.z);
    var below = layer_at(n, c, first + (max(z_first, 1u) - 1u) * plane, at, z_first > 0u);
    var here = layer_at(n, c, first + z_first * plane, at, true);
    var z = z_first;
    loop {
        let above = layer_at(n, c, first + min(z + 1u, n.z - 1u) * plane, at, z + 1u < n.z);
        let cell = z * plane + y * n.x + x;
        store(n, first + cell, at, Stepped(
            stepped_0(c, below, here, above, channel, cell),
            stepped_1(c, below, here, above, channel, cell + 1u),
            stepped_2(c, below, here, above, channel, cell + 2u),
            stepped_3(c, below, here, above, channel, cell + 3u)));
        below = here;
        here = above;
        z++;
        if (z >= z_last) {
            break;
        }
    }
}
