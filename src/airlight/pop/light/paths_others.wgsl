//! use ordinate_light
//! use other_media

// The others' density on the way to every ordinate, in the own box and, unless that is known,
// beyond it.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= params.ordinate_count || reach[id.x] == 0u) {
        return;
    }
    let point = cell_centre(cell_of(id.x));
    let light = ordinate_light(id.y, point);
    let back = -light.travel;
    let out = max(0.0, ray_box_interval(point, back, vec3f(0.0), params.extent).y);
    let inside = min(out, light.distance);
    let is_closed = ways.is_closed == 1u || ordinates[id.y].position.w == FROM_MEDIUM;
    let end = select(light.distance, inside, is_closed);
    for (var m = 1u; m < MEDIA; m++) {
        let part = (m + 1u) * params.ordinate_count + id.y;
        passed[part * params.cells + id.x] = density_between(m, point, back, 0.0, inside);
        let beyond = (MEDIA + m) * params.ordinate_count + id.y;
        passed[beyond * params.cells + id.x] = density_between(m, point, back, inside, end);
    }
}
