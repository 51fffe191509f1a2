// One step over tiles of columns, marched along z. A layer's cells send to three layers: what the
// nine around a column send is made of the sums (e) and differences (o) of neighbours along x, then
// along y. `layer_at`, `store` and `added` are generated; the size is handed to them, as reading it
// again costs as much as a cell.
//! use layer_hops

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let channel = id.z / params.slabs;
    let x = WIDTH * id.x;
    let y = HEIGHT * id.y;
    let z_first = (id.z % params.slabs) * SLAB;
    if (channel >= 3u || x >= n.x || y >= n.y || z_first >= n.z) {
        return;
    }
    let c = coefficients[params.row + channel];
    let w = weights(c);
    let plane = n.x * n.y;
    let first = channel * n.z * plane;
    let z_last = min(z_first + SLAB, n.z);
    // What layers so far have sent to the layer before this one, and to this one. One loop for all
    // layers, those beside the slab too, with its test at its end: `layer_at` is long.
    var earlier: Tile;
    var current: Tile;
    let end = min(z_last, n.z - 1u);
    var z = max(z_first, 1u) - 1u;
    loop {
        let layer = layer_at(n, c, w, first + z * plane, x, y);
        if (z > z_first) {
            store(vec2u(x, y), n, first + (z - 1u) * plane + y * n.x + x,
                added(earlier, layer.below));
        }
        earlier = added(current, layer.here);
        current = layer.above;
        z++;
        if (z > end) {
            break;
        }
    }
    if (z_last == n.z) {
        store(vec2u(x, y), n, first + (z_last - 1u) * plane + y * n.x + x, earlier);
    }
}
