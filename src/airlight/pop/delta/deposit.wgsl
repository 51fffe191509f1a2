// The power that leaves all beams in a cell, and the net power that it carries on; see
// maths/delta_beam.py, deposit.
//! use beam_light
//! use medium_grid
//! use missing_power
//! needs fn absorbing(cell: u32) -> vec3f
//! needs fn leaving_beams(cell: u32) -> vec3f
//! needs fn leaving_forward(cell: u32) -> vec3f
//! needs fn reduced_depth(n: u32, cell: u32) -> vec3f

// The mean of exp(-depth) over a cell, over that in its middle, for a depth that is linear along
// one axis; see mean_transmission in maths/delta_beam.py. At a border the slope is that of the
// other side.
fn slope_gain(before: vec3f, here: vec3f, after: vec3f, is_low: bool, is_high: bool) -> vec3f {
    let inner_rise = select(here - before, after - here, is_low);
    let outer_rise = select(after - here, here - before, is_high);
    let gentler = min(abs(inner_rise), abs(outer_rise));
    return sinh_quotient(0.5 * select(vec3f(0.0), gentler, inner_rise * outer_rise > vec3f(0.0)));
}

// sinh(x)/x for x >= 0.
fn sinh_quotient(x: vec3f) -> vec3f {
    let x2 = x * x;
    let series = 1.0 + x2 / 6.0 * (1.0 + x2 / 20.0);
    let safe = clamp(x, vec3f(0.1), vec3f(20.0));
    let grown = exp(safe);
    return select((grown - 1.0 / grown) / (2.0 * safe), series, x < vec3f(0.1));
}

fn axis_gain(n: u32, cell: u32, here: vec3f, axis: u32, at: u32, count: u32) -> vec3f {
    let stride = cell_stride(axis);
    let is_low = at == 0u;
    let is_high = at + 1u == count;
    let before = reduced_depth(n, select(cell - stride, cell, is_low));
    let after = reduced_depth(n, select(cell + stride, cell, is_high));
    return slope_gain(before, here, after, is_low, is_high);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    let cell = cell_of(id.x);
    let point = cell_centre(cell);
    let count = params.count;
    var power = vec3f(0.0);
    var x = vec3f(0.0);
    var y = vec3f(0.0);
    var z = vec3f(0.0);
    // Sums over the ordinates of irradiance, and of net irradiance along x, y, z.
    let leaving = leaving_beams(id.x);
    let is_any = any(leaving > vec3f(0.0));
    let loss = absorbing(id.x) + leaving;
    for (var n = 0u; n < params.ordinate_count && is_any; n++) {
        let light = beam_light(n, id.x, point);
        // Light that propagates in a grid leaves a residuum of its own.
        if (ordinates[n].position.w == VIRTUAL_GRID || all(light.irradiance <= vec3f(0.0))) {
            continue;
        }
        // The mean transmittance of the beam in the cell.
        let here = reduced_depth(n, id.x);
        let gain = axis_gain(n, id.x, here, 0u, cell.x, count.x)
            * axis_gain(n, id.x, here, 1u, cell.y, count.y)
            * axis_gain(n, id.x, here, 2u, cell.z, count.z);
        let s = light.irradiance * min(exp(-here) * gain, vec3f(1.0));
        let carried = s * ordinates[n].direction.w;
        power += s;
        if (ordinates[n].position.w == LOCAL) {
            power += missing_irradiance(n, id.x, point, loss);
        }
        x += carried * light.travel.x;
        y += carried * light.travel.y;
        z += carried * light.travel.z;
    }
    // W: times the scattering out of beams, and the part of it that keeps the direction.
    let volume = params.cell.x * params.cell.y * params.cell.z;
    let forward = volume * leaving_forward(id.x);
    deposits[id.x] = vec4f(max(volume * leaving * power, vec3f(0.0)), 0.0);
    deposits[id.x + params.cells] = vec4f(forward * x, 0.0);
    deposits[id.x + 2u * params.cells] = vec4f(forward * y, 0.0);
    deposits[id.x + 3u * params.cells] = vec4f(forward * z, 0.0);
}
