// `border` holds what comes into cells, W, then the track of the light on its path there, as it is and
// as surfaces may read it.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let index = (id.z * params.count.y + id.y) * params.count.x + id.x;
    let half = params.count.x * params.count.y * params.count.z;
    cells[index] += border[index];
    beams[index] = base[index] + border[half + index];
    surface_beams[index] = base[index] + border[2u * half + index];
}
