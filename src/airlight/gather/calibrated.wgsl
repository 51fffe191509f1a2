// Adds to each path what lattices know of the light at its end, calibrated.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let path = id.y * params.width + id.x;
    if (id.x >= params.width || path >= params.paths) {
        return;
    }
    let known = paths[2u * path + 1u];
    // Where lattices have a share in the path.
    if (known.w > 0.0) {
        paths[2u * path] += vec4f(factor[0] * known.rgb, 0.0);
    }
}
