// The column densities of the other media between a cell and an ordinate: in the medium's own box
// and, unless the boundary is closed or the ordinate is a block, whose light is known at the box,
// beyond it.
//! use ordinate_light
//! use other_media
//! use medium_grid

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= params.ordinate_count || reach[id.x] == 0u) {
        return;
    }
    // Where the path leaves the box, and where it ends.
    let point = cell_centre(cell_of(id.x));
    let light = ordinate_light(id.y, point);
    let back = -light.travel;
    let out = max(0.0, ray_box_interval(point, back, vec3f(0.0), params.extent).y);
    let inside = min(out, light.distance);
    let is_closed = others.is_closed == 1u || ordinates[id.y].position.w == BLOCK;
    let end = select(light.distance, inside, is_closed);
    // Both parts apart: beyond the box what is scattered forwards spreads sideways, and comes from blocks.
    for (var m = 1u; m < MEDIA; m++) {
        let part = (m + 1u) * params.ordinate_count + id.y;
        passed[part * params.cells + id.x] = density_between(m, point, back, 0.0, inside);
        let beyond = (MEDIA + m) * params.ordinate_count + id.y;
        passed[beyond * params.cells + id.x] = density_between(m, point, back, inside, end);
    }
}
