// The sums of points, once all of their rays are in them, as an image that neighbours read.
//! use stored_sums

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    store_sums(id.xy, sums[id.y * params.reduced.x + id.x]);
}
