// `border` holds what comes into cells, W, then the track of the light on its path there, as it is and
// as surfaces may read it.
//! use cell_order
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let index = cell_in(params.count, id);
    let half = params.count.x * params.count.y * params.count.z;
    // What comes in hops on from the cell; its track adds to that of beams, as media and as surfaces read them.
    cells[index] += border[index];
    beams[index] = base[index] + border[half + index];
    surface_beams[index] = base[index] + border[2u * half + index];
}
