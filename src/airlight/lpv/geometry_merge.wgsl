// A view's sums into the volume: of each corner the larger of both; the sums are emptied for the next view.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = params.count + 1u;
    if (id.x >= size.x * size.y * size.z) {
        return;
    }
    // The larger of both, as a whole vector.
    let first = 5u * id.x;
    let seen = vec4f(vec4i(sums[first], sums[first + 1u], sums[first + 2u], sums[first + 3u]))
        / params.units;
    if (seen.x > volume[id.x].x) {
        volume[id.x] = seen;
        reflected[id.x] = f32(sums[first + 4u]) / params.units;
    }
    for (var k = 0u; k < 5u; k++) {
        sums[first + k] = 0;
    }
}
