// The density of a fine cell: the mean of samples of the voxels, 0 outside the volume.
//! use cell_order

const FINE = 2.0;   // fine cells per cell and axis (FINE in placement.py)

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= 2u * params.count)) {
        return;
    }
    let n = params.samples;
    let total = n.x * n.y * n.z;
    var sum = 0.0;
    for (var s = 0u; s < total; s++) {
        // The sample's offset in the fine cell, then its coordinates in the volume.
        let inside = (vec3f(cell_at_index(n, s)) + 0.5) / vec3f(n);
        let point = (vec3f(id) + inside) * params.cell / FINE;
        let uvw = (params.unit_from_medium * vec4f(point, 1.0)).xyz;
        if (all(uvw > vec3f(0.0)) && all(uvw < vec3f(1.0))) {
            sum += textureSampleLevel(voxels, linear_clamp, uvw, 0.0).x;
        }
    }
    textureStore(fine, id, vec4f(sum / f32(total), 0.0, 0.0, 0.0));
}
