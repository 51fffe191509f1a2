//! use media

// Whether a cell touches a medium's box at all; most do not, and sampling costs.
fn touches(m: u32, centre: vec3f) -> bool {
    let half = 0.5 * lattice.cell;
    let to = media[m].volume_from_world;
    let reach = half * (abs(to[0].xyz) + abs(to[1].xyz) + abs(to[2].xyz));
    let place = medium_coordinates(m, centre);
    return all(place > -reach) && all(place < 1.0 + reach);
}

// rgb: scattering as if it were even; a: extinction with that, the channels' mean; m^-1.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let low = lattice.origin + vec3f(id) * lattice.cell;
    let n = params.places;
    var scattering = vec3f(0.0);
    var extinction = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        let count = select(0u, n * n * n, touches(m, low + 0.5 * lattice.cell));
        var density = 0.0;
        for (var k = 0u; k < count; k++) {
            let inside = (vec3f(vec3u(k % n, (k / n) % n, k / (n * n))) + 0.5) / f32(n);
            density += medium_density(m, low + inside * lattice.cell);
        }
        density /= f32(n * n * n);
        let s = media[m].sigma_t * media[m].albedo;
        scattering += density * s * (1.0 - media[m].g);
        extinction += density * (media[m].sigma_t - s * media[m].g);
    }
    let cell = (id.z * lattice.count.y + id.y) * lattice.count.x + id.x;
    cells[cell] = vec4f(scattering, (extinction.r + extinction.g + extinction.b) / 3.0);
}
