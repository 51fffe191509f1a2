// The column density between a cell and an ordinate inside the medium's box, by the midpoint rule:
// the transmittance that starts an ordinate's light (Elek2014 section 4.1; maths.delta_beam.light).
//! use ordinate_light
//! use medium
//! use medium_grid

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= params.ordinate_count) {
        return;
    }
    // No surface is known of yet, and cells out of reach need no light.
    passed[(params.ordinate_count + id.y) * params.cells + id.x] = 1.0;
    if (reach[id.x] == 0u) {
        passed[id.y * params.cells + id.x] = 0.0;
        return;
    }
    // Back along the light to where it enters the box, or to a local light inside.
    let point = cell_centre(cell_of(id.x));
    let light = ordinate_light(id.y, point);
    let back = -light.travel;
    let inside = max(0.0, ray_box_interval(point, back, vec3f(0.0), params.extent).y);
    let length = min(inside, light.distance);
    // Steps of at most the shortest side of a cell.
    let longest = min(params.cell.x, min(params.cell.y, params.cell.z));
    let steps = max(1.0, ceil(length / longest));
    let dt = length / steps;
    let stride = dt * back / params.extent;
    var uvw = point / params.extent + 0.5 * stride;
    var sum = 0.0;
    for (var k = 0u; k < u32(steps); k++) {
        sum += textureSampleLevel(fine, linear_clamp, uvw, 0.0).x;
        uvw += stride;
    }
    passed[id.y * params.cells + id.x] = sum * dt;
}
