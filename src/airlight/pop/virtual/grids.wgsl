// The grids of all virtual point lights, by one workgroup.
//! use ordinate_grid
//! use ordinate_kind

const PI = 3.14159265;

var<workgroup> powers: array<f32, WX>;

// Shells around a virtual point light; see maths/radial_grid.py, radial_grid.
fn around(n: u32, centre: vec3f) {
    let corner = max(centre, params.extent - centre);
    grids[n].corner = centre;
    grids[n].radius = length(corner);
    grids[n].growth = shape.growth;
    grids[n].count = vec3u(shape.side, shape.side, shape.shells);
    grids[n].is_radial = 1u;
}

// A parallel grid, for a virtual point light so far away that shells would be coarser than the
// medium.
fn along(n: u32, d: vec3f) {
    let g = ordinate_grid(params.extent, d, hops.capacity);
    grids[n].axis_x = g.axes[0];
    grids[n].axis_y = g.axes[1];
    grids[n].axis_z = d;
    grids[n].corner = g.corner;
    grids[n].cell = g.cell;
    grids[n].count = g.count;
    grids[n].is_radial = 0u;
}

// The mean cosine of directions to a disc of pi `b` m^2, from `distance` metres before it.
fn mean_cosine(b: f32, distance: f32) -> f32 {
    return 0.5 + 0.5 * distance / sqrt(distance * distance + b);
}

// Place the grid of light n; its power, W in units of the table's scale. A dark light gets no
// cells.
fn placed(n: u32) -> f32 {
    let o = ordinates[hops.first_row + n];
    let sent = PI * max(o.irradiance.r, max(o.irradiance.g, o.irradiance.b));
    let away = 0.5 * params.extent - o.position.xyz;
    let distance = length(away);
    if (distance > shape.far * 0.5 * length(params.extent)) {
        along(n, away / distance);
    } else {
        around(n, o.position.xyz);
    }
    grids[n].mean_cosine = select(1.0, mean_cosine(o.spot.x, distance), shape.is_blurred == 1u);
    if (o.position.w != VIRTUAL_GRID || sent <= 0.0) {
        grids[n].count = vec3u(0u);
        return 0.0;
    }
    return sent;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32) {
    // Each lane places some of the grids, and adds up the power of their lights.
    var own = 0.0;
    for (var n = shape.first + lane; n < hops.grids; n += WX) {
        own += placed(n);
    }
    // The residuum of all lights fits into the integers that it is summed in.
    powers[lane] = own;
    workgroupBarrier();
    if (lane == 0u) {
        var sum = shape.power;
        for (var k = 0u; k < WX; k++) {
            sum += powers[k];
        }
        grids[0].fixed_scale = shape.most / max(sum, 1e-30);
    }
}
