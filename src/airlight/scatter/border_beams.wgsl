// Light of an endless medium around the lattices on its straight path into one of them: each cell's fluence and
// flux, and what walls beside the cell turn back of it. LEVELS, TURNS, ROWS and LAST are generated.
//! use media
//! use open_line
//! use cell_order

// W m^-2 sr^-1 that the medium outside sends from a point of the border, seen on a level of directions.
fn incoming(level: u32, depth: f32) -> vec3f {
    let row = min(depth / (1.0 + depth) / LAST, 1.0) * f32(ROWS - 1u);
    let i = min(u32(row), ROWS - 2u);
    let first = level * ROWS + i;
    return mix(radiance[first].rgb, radiance[first + 1u].rgb, row - f32(i));
}

// To where a ray from p leaves a lattice, m.
fn leaving(grid: LatticeParams, p: vec3f, direction: vec3f) -> f32 {
    let low = grid.origin;
    return ray_box_interval(lattice_from_world(grid, p), lattice_from_world(grid, direction),
        low,
        low + grid.cell * vec3f(grid.count)).y;
}

// How open the path from p in the lattice's cells is to the largest lattice's border, `reach` metres away. Beyond the
// lattice the cells of the largest know the walls.
fn open_to_border(begin: vec3f, p: vec3f, out: vec3f, reach: f32) -> f32 {
    if (params.is_nested == 0u) {
        return open_line(begin, warped_coordinates(lattice, p + reach * out));
    }
    let edge = p + min(leaving(lattice, p, out), reach) * out;
    let open = open_line(begin, warped_coordinates(lattice, edge));
    if (open <= 0.01) {
        return 0.0;
    }
    let far = warped_coordinates(outer, p + reach * out);
    return open * open_line_of(outer, warped_coordinates(outer, edge), far);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    // What arrives at the cell's centre: fluence, net flux, and irradiance of six walls.
    let p = unwarped_point(lattice, id, vec3f(0.5));
    var fluence = vec3f(0.0);
    var flux = mat3x3f();                   // columns x, y, z of rgb
    var against: array<vec3f, 6>;           // irradiance of faces +x -x +y -y +z -z from within
    // Rays into all directions: what comes in at their ends, attenuated, past walls.
    for (var k = 0u; k < LEVELS * TURNS; k++) {
        let level = k / TURNS;
        let up = directions[level].x;
        let turn = (f32(k % TURNS) + 0.5 * f32(level & 1u) + 0.25) * (6.2831853 / f32(TURNS));
        let out = vec3f(sqrt(1.0 - up * up) * vec2f(cos(turn), sin(turn)), up).xzy;
        let reach = leaving(outer, p, out);
        let end = p + reach * out;
        let passed = exp(-media_optical_depth(p, out, 0.0, reach));
        let sent = directions[level].y * passed
            * incoming(level, params.sigma * max(params.top - end.y, 0.0));
        // Nothing is walked where nothing comes from, as from above the medium.
        if (all(sent <= vec3f(0.0))) {
            continue;
        }
        let light = sent * open_to_border(vec3f(id) + 0.5, p, out, reach);
        fluence += light;
        let away = lattice_from_world(lattice, out);
        flux -= mat3x3f(light * away.x, light * away.y, light * away.z);
        for (var axis = 0u; axis < 3u; axis++) {
            against[2u * axis] += light * max(-away[axis], 0.0);
            against[2u * axis + 1u] += light * max(away[axis], 0.0);
        }
    }
    // The cell's power: what its medium scatters, and what its walls reflect along their normals.
    let colour = unpack4x8unorm(reflectance[cell_of(id)]).rgb;
    let area = lattice.cell * lattice.cell;
    let volume = lattice.cell * area;
    var power = media_coefficients(p).scattering * fluence * volume;
    var turned = mat3x3f();
    var walls = vec3f(1e-3);
    for (var face = 0u; face < 6u; face++) {
        let is_high = (face & 1u) == 0u;
        let shut = 1.0 - open_face(vec3i(id), face / 2u, is_high);
        let back = params.has_walls * shut * area * colour * against[face];
        power += back;
        turned[face / 2u] += select(SHARPNESS, -SHARPNESS, is_high) * back;
        walls[face / 2u] += shut;
    }
    // Two bands would read flat light on a floor as too bright: what the cell's walls get of it is
    // known, and so surfaces are told of a constant term that would bring them that.
    var constant = vec3f(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        constant += walls[axis] * 2.0 * (against[2u * axis] + against[2u * axis + 1u]);
    }
    constant /= walls.x + walls.y + walls.z;
    // The flux only towards walls that there are; then power units: W, and W m of track.
    let share = walls / max(walls.x, max(walls.y, walls.z));
    let cells = lattice.count.x * lattice.count.y * lattice.count.z;
    for (var c = 0u; c < 3u; c++) {
        let index = c * cells + cell_of(id);
        let along = vec3f(flux[0][c], flux[1][c], flux[2][c]);
        border[index] = vec4f(power[c], turned[0][c], turned[1][c], turned[2][c]);
        border[3u * cells + index] = volume * vec4f(fluence[c], along);
        border[6u * cells + index] = volume * vec4f(constant[c], share * along);
    }
}

fn cell_of(id: vec3u) -> u32 {
    return cell_in(lattice.count, id);
}
