// The extinction of all media of a kind in fine cells, as the density of one medium.
//! use media
//! use members
//! use cell_order
//! use half_range

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    // Media one after the other, each at all samples of the cell: few meet it.
    let n = params.samples;
    let size = 1.0 / vec3f(params.count);
    let centre = (params.world_from_uvw * vec4f((vec3f(id) + 0.5) * size, 1.0)).xyz;
    var sum = vec3f(0.0);
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_near(node, centre, params.reach);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped || !is_member(visit.medium, params.members_low, params.members_high)) {
            continue;
        }
        var density = 0.0;
        for (var s = 0u; s < n * n * n; s++) {
            let inside = (vec3f(cell_at_index(vec3u(n), s)) + 0.5) / f32(n);
            let uvw = (vec3f(id) + inside) * size;
            density += medium_density(visit.medium, (params.world_from_uvw * vec4f(uvw, 1.0)).xyz);
        }
        sum += density * row_of_media(visit.medium).sigma_t;
    }
    // One density for all channels, cut to what a half float holds.
    let mean = params.scale * (sum.r + sum.g + sum.b) / (3.0 * f32(n * n * n));
    textureStore(voxels, id, vec4f(min(mean, LARGEST_HALF), 0.0, 0.0, 0.0));
}
