// The column density between a finer grid and each ordinate, outside the grid's box and inside the
// whole medium's; added to that inside. See paths.wgsl.
//! use ordinate_light
//! use medium
//! use medium_grid

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= params.ordinate_count || reach[id.x] == 0u) {
        return;
    }
    // From where the path leaves the grid to where it leaves the medium, or to a local light.
    let point = cell_centre(cell_of(id.x));
    let light = ordinate_light(id.y, point);
    let back = -light.travel;
    let inside = ray_box_interval(point, back, vec3f(0.0), params.extent);
    let whole = ray_box_interval(point, back, beyond.low, beyond.low + beyond.extent);
    let begin = max(max(0.0, inside.y), whole.x);
    let end = min(whole.y, light.distance);
    if (end <= begin) {
        return;
    }
    // The midpoint rule, as inside the grid.
    let steps = ceil((end - begin) / beyond.step);
    let dt = (end - begin) / steps;
    let stride = dt * back / beyond.extent;
    var uvw = (point + begin * back - beyond.low) / beyond.extent + 0.5 * stride;
    var sum = 0.0;
    for (var k = 0u; k < u32(steps); k++) {
        sum += textureSampleLevel(fine, linear_clamp, uvw, 0.0).x;
        uvw += stride;
    }
    passed[id.y * params.cells + id.x] += sum * dt;
}
