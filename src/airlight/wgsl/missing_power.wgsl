//! use ordinate_light

// Light of a local light that means over the cells around it leave out; see maths/point_light_beam.py,
// missing_irradiance. The including pass binds `params` (MediumParams), `ordinates` and `passed`.

const BLOCK_SIDE = 4u;  // cells of the block around a light

// In the block around a light `away` from a cell's middle, the integral of exp(-loss r)/r^2, m, less that of cells.
fn missing_integral(away: vec3f, loss: vec3f) -> vec3f {
    // The eight cells whose middles surround the light, and one more on each side.
    let first = away + select(vec3f(-2.0), vec3f(-1.0), away <= vec3f(0.0)) * params.cell;
    let volume = params.cell.x * params.cell.y * params.cell.z;
    var cells = vec3f(0.0);
    for (var k = 0u; k < BLOCK_SIDE * BLOCK_SIDE * BLOCK_SIDE; k++) {
        let at = first + vec3f(vec3u(k, k / BLOCK_SIDE, k / (BLOCK_SIDE * BLOCK_SIDE)) % BLOCK_SIDE) * params.cell;
        cells += volume * mean_inverse_square(at) * exp(-loss * length(at));
    }
    // Along rays to the faces of the block it is (1 - exp(-loss r))/loss.
    var whole = vec3f(0.0);
    var directions = 0.0;
    for (var k = 0u; k < 6u * BLOCK_SIDE * BLOCK_SIDE; k++) {
        let axis = k / (2u * BLOCK_SIDE * BLOCK_SIDE);
        var step = vec3f(0.0);
        step[axis] = select(-0.5, f32(BLOCK_SIDE) - 0.5, (k & 1u) == 1u);
        step[(axis + 1u) % 3u] = f32((k / 2u) % BLOCK_SIDE);
        step[(axis + 2u) % 3u] = f32((k / (2u * BLOCK_SIDE)) % BLOCK_SIDE);
        let at = first + step * params.cell;
        let r = length(at);
        let share = abs(at[axis]) / (params.cell[axis] * r * r * r);
        let depth = max(loss * r, vec3f(1e-4));
        whole += share * r * (1.0 - exp(-depth)) / depth;
        directions += share;
    }
    return 12.566371 * whole / directions - cells;
}

// Of local light n, as the mean irradiance of a cell, whose beams lose `loss`, m^-1.
fn missing_irradiance(n: u32, cell: u32, point: vec3f, loss: vec3f) -> vec3f {
    // The eight cells around the light share it.
    let o = ordinates[n];
    let away = point - o.position.xyz;
    let near = max(1.0 - abs(away) / params.cell, vec3f(0.0));
    let share = near.x * near.y * near.z;
    if (share <= 0.0) {
        return vec3f(0.0);
    }
    let volume = params.cell.x * params.cell.y * params.cell.z;
    let lit = passed[(params.ordinate_count + n) * params.cells + cell] * o.spot.z;
    return o.irradiance.rgb * lit * share / volume * missing_integral(away, loss);
}
