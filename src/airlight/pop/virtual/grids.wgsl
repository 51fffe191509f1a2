//! use ordinate_grid
//! use ordinate_kind

const PI = 3.14159265;

var<workgroup> powers: array<f32, WX>;

// Shells around a virtual light; see maths/radial_grid.py, radial_grid.
fn around(n: u32, centre: vec3f) {
    let corner = max(centre, params.extent - centre);
    grids[n].corner = centre;
    grids[n].radius = length(corner);
    grids[n].growth = place.growth;
    grids[n].count = vec3u(place.side, place.side, place.shells);
    grids[n].is_radial = 1u;
}

// A virtual light so far away that shells would be coarser than the medium.
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

// Mean cosine of a disc of pi `b` m^2 as it is seen from `distance`, m, before it.
fn mean_cosine(b: f32, distance: f32) -> f32 {
    return 0.5 + 0.5 * distance / sqrt(distance * distance + b);
}

// Its power, W in units of the table's scale; a light that sends none gets no cells.
fn placed(n: u32) -> f32 {
    let o = ordinates[hops.first_row + n];
    let sent = PI * max(o.irradiance.r, max(o.irradiance.g, o.irradiance.b));
    let away = 0.5 * params.extent - o.position.xyz;
    let distance = length(away);
    if (distance > place.far * 0.5 * length(params.extent)) {
        along(n, away / distance);
    } else {
        around(n, o.position.xyz);
    }
    grids[n].mean_cosine = select(1.0, mean_cosine(o.spot.x, distance), place.is_blurred == 1u);
    if (o.position.w != HOPS_ON || sent <= 0.0) {
        grids[n].count = vec3u(0u);
        return 0.0;
    }
    return sent;
}

// One workgroup: all virtual lights, and what all lights' residuum can be.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32) {
    var own = 0.0;
    for (var n = place.first + lane; n < hops.grids; n += WX) {
        own += placed(n);
    }
    powers[lane] = own;
    workgroupBarrier();
    if (lane == 0u) {
        var sum = place.power;
        for (var k = 0u; k < WX; k++) {
            sum += powers[k];
        }
        grids[0].fixed_scale = place.most / max(sum, 1e-30);
    }
}
