// The mean densities of the other media in the cells of this medium.
//! use medium_grid
//! needs fn fine_of(m: u32, uvw: vec3f) -> f32

const SIDE = 4u;    // samples along each axis of a cell

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    // id.y is the medium; the first is this one, whose density is known.
    if (id.x >= params.cells || id.y == 0u || id.y >= MEDIA) {
        return;
    }
    let cell = vec3f(cell_of(id.x));
    var sum = 0.0;
    for (var s = 0u; s < SIDE * SIDE * SIDE; s++) {
        let inside = (vec3f(vec3u(s % SIDE, (s / SIDE) % SIDE, s / (SIDE * SIDE))) + 0.5)
            / f32(SIDE);
        let point = (cell + inside) * params.cell;
        let uvw = (row_of_media(id.y).uvw_from_medium * vec4f(point, 1.0)).xyz;
        if (all(uvw > vec3f(0.0)) && all(uvw < vec3f(1.0))) {
            sum += fine_of(id.y, uvw);
        }
    }
    density[id.y * params.cells + id.x] = sum / f32(SIDE * SIDE * SIDE);
}
