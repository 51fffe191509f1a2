// One virtual point light per stratum: the texel at an equal step of the running sum of weights.
//! use reflecting_texel
//! use lattice_space

const GOLDEN = 0.61803399;

// The first tile whose running sum is beyond u, by bisection.
fn tile_of(u: f32) -> u32 {
    var low = 0u;
    var high = params.all_tiles - 1u;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (tiles[middle] > u) { high = middle; } else { low = middle + 1u; }
    }
    return low;
}

// The area of a virtual point light, m^2. Several lights on one surface share its virtual point
// lights, which then lie closer than those of one light: at most as far apart as on a uniformly
// bright plane.
fn piece_area(taken: Reflecting, texels: f32) -> f32 {
    let away = params.centre - taken.point;
    let r2 = dot(away, away) + params.radius * params.radius;
    return min(texels * taken.area, 2.0 * PI * r2 / f32(params.count));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.count) {
        return;
    }
    // Jittered, because a stratum may be several whole maps of the sky, whose middles would all be
    // the same point.
    let total = tiles[params.all_tiles - 1u];
    let share = total / f32(params.count);
    let u = (f32(id.x) + fract(GOLDEN * f32(id.x) + 0.5)) * share;
    let tile = tile_of(u);
    let side = params.side;
    let mine = tile - params.first_tile;
    if (tile < params.first_tile || mine >= side * side * params.layers) {
        return;
    }
    // The texel of the tile at which the sum is reached.
    let first = TILE * vec2u(mine % side, (mine / side) % side);
    let layer = mine / (side * side);
    var left = u - select(tiles[max(tile, 1u) - 1u], 0.0, tile == 0u);
    var taken = DARK;
    for (var k = 0u; k < TILE * TILE && left >= 0.0; k++) {
        // Every other row backwards, so that neighbours in the row are neighbours on the map.
        let y = k / TILE;
        let x = select(k % TILE, TILE - 1u - k % TILE, (y & 1u) == 1u);
        let texel = first + vec2u(x, y);
        if (all(texel < vec2u(params.resolution))) {
            let one = reflecting(texel, layer);
            left -= one.weight;
            if (one.weight > 0.0) { taken = one; }
        }
    }
    // The number of texels that it stands for, and its row of the ordinates.
    let texels = select(0.0, share / taken.weight, taken.weight > 0.0);
    let row = params.first_row + id.x;
    let p = (params.medium_from_world * vec4f(taken.point, 1.0)).xyz;
    let n = (params.medium_from_world * vec4f(taken.normal, 0.0)).xyz;
    ordinates[row].direction = vec4f(n, 1.0);
    ordinates[row].irradiance = vec4f(texels / PI * taken.flux / params.scale, 0.0);
    ordinates[row].position = vec4f(p, params.kind);
    ordinates[row].spot = vec4f(piece_area(taken, texels) / PI, 0.0, 0.0, 0.0);
    // Half a cell before the surface, in lattice coordinates.
    let own = lattice_from_world(lattice, taken.normal);
    light_cells[id.x] = vec4f(warped_surface_coordinates(lattice, taken.point, own) + 0.5 * own, 1.0);
}
