// A cell's mean scattering and extinction, m^-1, over samples^3 points of it.
//! use media
//! use lattice_axes

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let n = params.samples;
    var scattering = vec3f(0.0);
    var extinction = vec3f(0.0);
    for (var k = 0u; k < n * n * n; k++) {
        let inside = (vec3f(vec3u(k % n, (k / n) % n, k / (n * n))) + 0.5) / f32(n);
        let p = world_from_cells(lattice, vec3f(id) + inside);
        let held = media_coefficients(p);
        scattering += held.scattering;
        extinction += held.extinction;
    }
    let share = 1.0 / f32(n * n * n);
    let cells_in_all = lattice.count.x * lattice.count.y * lattice.count.z;
    let cell = (id.z * lattice.count.y + id.y) * lattice.count.x + id.x;
    for (var channel = 0u; channel < 3u; channel++) {
        medium[channel * cells_in_all + cell] = share
            * vec2f(scattering[channel], extinction[channel]);
    }
}
