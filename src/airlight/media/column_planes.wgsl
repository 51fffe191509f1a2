// The mean densities at the texels of one plane of each grid, towards each light. The planes on its
// lit side are known.
//! use column_paths

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.y >= params.lights || id.z >= params.grids) {
        return;
    }
    // The planes lie across the axis that paths towards the light go along most.
    let g = listed[params.first + id.z];
    let grid = grids[g];
    let path = paths[g * params.lights + id.y];
    let count = vec3f(grid.count);
    let size = in_plane(path, count);
    let depth = f32(params.plane + 1u) * path.thickness - 1.0;
    let last = dot(abs(path.facing), count) - 1.0;
    if (depth >= last) {
        return;
    }
    let across = abs(path.facing);
    let corner = across * select(depth, last - depth, dot(path.facing, vec3f(1.0)) > 0.0);
    let slot = id.z * params.lights + id.y;
    // Some of the plane's texels (u, v) along the axes after its own.
    let texels = u32(size.x * size.y);
    let apart = (texels + RUN - 1u) / RUN;
    if (id.x >= apart) {
        return;
    }
    for (var i = id.x; i < texels; i += apart) {
        let row = floor((f32(i) + 0.5) / size.x);
        let texel = corner + across.zxy * (f32(i) - row * size.x) + across.yzx * row;
        planes[plane_first(slot, f32(params.plane)) + i] = mean_towards(grid, path, texel, slot);
    }
}
