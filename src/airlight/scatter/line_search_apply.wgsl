// One step of the corrected sum: the step is linear, so it is that of the sum and of the correction.
//! use cell_order

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    if (id.x >= n.x || id.y >= n.y || id.z >= 3u * n.z) {
        return;
    }
    let index = cell_in(n, id);
    // The correction of each channel has a length of its own.
    corrected[index] = stepped[index] + lengths[id.z / n.z] * answer[index];
}
