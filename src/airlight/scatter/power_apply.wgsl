// One step of the scaled sum: the source is not scaled, what it has become is.
//! use cell_order

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    if (id.x >= n.x || id.y >= n.y || id.z >= 3u * n.z) {
        return;
    }
    let index = cell_in(n, id);
    // source + scale (stepped - source).
    rescaled[index] = mix(source[index], stepped[index], scales[id.z / n.z]);
}
