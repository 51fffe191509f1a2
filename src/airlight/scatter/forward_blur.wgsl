// Each light's forward light, averaged along one axis of the lattice over REACH cells to each side, as
// far as the faces between are open: what is lit beyond a wall stays there. The slabs of both textures
// along z are lights.
//! use entering_share
//! use cell_order

fn entering(cell: vec3u, hop: u32) -> f32 {
    let index = cell_in(params.count, cell);
    return entering_share(face_visibility[index], hop);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= vec3u(params.count.xy, params.count.z * params.lights))) {
        return;
    }
    // A cell of one light's slab, in which the lattice has rows of its own.
    let own = vec3u(id.xy, id.z % params.count.z);
    let slab = vec3u(0u, params.first_row, id.z / params.count.z * params.depth);
    // The mean of the cells to both sides, each by how open the faces before it are.
    var sum = textureLoad(light, own + slab, 0);
    var weight = 1.0;
    for (var side = 0u; side < 2u; side++) {
        // From the neighbour at the high side light comes on the hop along the negative axis.
        let is_high = side == 1u;
        let hop = 2u * params.axis + side;
        var cell = own;
        var open = 1.0;
        for (var k = 0u; k < REACH; k++) {
            let end = select(0u, params.count[params.axis] - 1u, is_high);
            if (cell[params.axis] == end || open < 0.01) {
                break;
            }
            open *= entering(cell, hop);
            cell[params.axis] = select(cell[params.axis] - 1u, cell[params.axis] + 1u, is_high);
            sum += open * textureLoad(light, cell + slab, 0);
            weight += open;
        }
    }
    textureStore(blurred, own + slab, sum / weight);
}
