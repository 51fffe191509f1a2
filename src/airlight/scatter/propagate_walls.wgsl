// One step among walls over tiles of 4 x 2 cells a lane, marched along z: a layer of four rows is
// loaded once, two cells at a time, and used for the layer below it, its own and the one above.
// What stands beside a lane's cells comes from the lanes beside it. nx is even.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let slabs = params.slabs;
    let layers = (n.z + slabs - 1u) / slabs;
    let channel = id.z / slabs;
    let x = WIDTH * id.x;
    let y = HEIGHT * id.y;
    let z_first = (id.z % slabs) * layers;
    if (channel >= 3u || x >= n.x || y >= n.y || z_first >= n.z) {
        return;
    }
    let c = coefficients[params.row + channel];
    let at = vec2u(x, y);
    let plane = n.x * n.y;
    let first = channel * n.z * plane;
    let z_last = min(z_first + layers, n.z);
    var below = layer_at(n, c, first + (max(z_first, 1u) - 1u) * plane, at, z_first > 0u);
    var here = layer_at(n, c, first + z_first * plane, at, true);
    var z = z_first;
    loop {
        let above = layer_at(n, c, first + min(z + 1u, n.z - 1u) * plane, at, z + 1u < n.z);
        let cell = z * plane + y * n.x + x;
        store(n, first + cell, at, stepped(n, c, below, here, above, channel, cell));
        below = here;
        here = above;
        z++;
        if (z >= z_last) {
            break;
        }
    }
}
