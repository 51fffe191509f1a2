//! use sampling

// A grid of cubes along a direction that spans a box; see maths/ordinate_grid.py.

const GRID_ROLLS = 16u;
const GRID_TIGHT = 1.01;
const GRID_QUARTER_TURN = 1.5707963267948966;

struct OrdinateGrid {
    axes: mat3x3f,  // columns x, y and z, the light's travel
    corner: vec3f,  // m
    cell: f32,      // m
    count: vec3u,
}

fn ordinate_grid_count(spanned: vec3f, cell: f32) -> vec3u {
    return vec3u(max(ceil(spanned / cell - 1e-6), vec3f(1.0)));
}

// Of at most `cells` cubes, over a box of `extent`, m.
fn ordinate_grid(extent: vec3f, d: vec3f, cells: u32) -> OrdinateGrid {
    let frame = orthonormal_frame(d);
    // Turned about the light such that the box's section across it is smallest.
    var best = frame;
    var least = 1e38;
    for (var k = 0u; k < GRID_ROLLS; k++) {
        let angle = f32(k) * GRID_QUARTER_TURN / f32(GRID_ROLLS);
        let x = cos(angle) * frame[0] + sin(angle) * frame[1];
        let y = cos(angle) * frame[1] - sin(angle) * frame[0];
        let area = dot(abs(x), extent) * dot(abs(y), extent);
        // The first of equals, whatever rounding makes of them.
        if (area < least * (1.0 - 1e-6)) {
            least = area;
            best = mat3x3f(x, y, d);
        }
    }
    // Cubes that fill it, made larger until they are few enough.
    let spanned = vec3f(dot(abs(best[0]), extent), dot(abs(best[1]), extent),
        dot(abs(best[2]), extent));
    var cell = pow(spanned.x * spanned.y * spanned.z / f32(cells), 1.0 / 3.0);
    var count = ordinate_grid_count(spanned, cell);
    for (var k = 0u; k < 200u && count.x * count.y * count.z > cells; k++) {
        cell *= GRID_TIGHT;
        count = ordinate_grid_count(spanned, cell);
    }
    let corner = 0.5 * extent - best * (0.5 * cell * vec3f(count));
    return OrdinateGrid(best, corner, cell, count);
}
