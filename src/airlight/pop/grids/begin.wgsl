// Light that scatters once in the cells of a grid, column by column along its light: the first
// state (Elek2014 section 4.1).
//! use hop_light
//! use ordinate_kind
//! use cell_order

const BARELY_LIT = 1e-3;    // visibility below which its changes say nothing of surfaces

// Visibility of an ordinate's light from a point: that of the medium's cell
// there.
fn visibility_at(row: u32, point: vec3f) -> f32 {
    let cell = vec3u(clamp(point / params.cell, vec3f(0.0), vec3f(params.count) - 1.0));
    let index = cell_in(params.count, cell);
    return passed[(params.ordinate_count + row) * params.cells + index];
}

// Irradiance before media and surfaces attenuate it, W m^-2 in units of the table's scale, times
// the section of a cell.
fn entering(n: u32, cell: vec3u, point: vec3f) -> vec3f {
    let o = ordinates[hops.first_row + n];
    let g = grids[n];
    let section = g.cell * g.cell;
    if (o.position.w == DISTANT) {
        return o.irradiance.rgb * section;
    }
    let away = point - o.position.xyz;
    let r2 = max(dot(away, away), 1e-18);
    let cosine = dot(away / sqrt(r2), o.direction.xyz);
    // A virtual point light is a piece of surface; see wgsl/ordinate_light.wgsl.
    let strength = select(smoothstep(o.spot.y, o.spot.x, cosine) / r2,
        max(cosine, 0.0) / (r2 + o.spot.x), o.position.w == VIRTUAL_GRID);
    let across = select(section, r2 * solid_angles[cell.y * g.count.x + cell.x], g.is_radial == 1u);
    return o.irradiance.rgb * strength * across;
}

// One column of a grid, along its light.
fn begin_column(n: u32, column: u32) {
    let a = vec3f(grids[n].mean_cosine)
        * select(params.g, vec3f(1.0), hops.is_paper == 1u);
    var tau = vec3f(0.0);
    var darkest = 1.0;
    for (var z = 0u; z < grids[n].count.z; z++) {
        var cell = hop_cell(n, column);
        cell.z = z;
        let index = hop_index(n, cell);
        let slot = hop_slot(n, index);
        let rho = max(hop_rho[n * hops.capacity + index], 0.0);
        let depth = rho * params.sigma_t * hop_path(n, z);
        let point = hop_point(n, vec3f(cell) + 0.5);
        // What enters the cell, and of that what scatters once in it.
        let lit = visibility_at(hops.first_row + n, point);
        var power = lit * entering(n, cell, point);
        if (hops.is_paper == 1u) {
            power *= exp(-(tau + 0.5 * depth));
        } else {
            power *= params.albedo * (exp(-tau) - exp(-(tau + depth)));
        }
        tau += depth;
        // A surface between this cell and the one before stops light that propagates across it,
        // too.
        let gate = select(1.0, min(1.0, lit / darkest), darkest > BARELY_LIT);
        darkest = min(darkest, lit);
        send_out(slot, power, a, gate);
        // What the eye sees of it, of half the path in the cell on average.
        var seen = vec3f(0.0);
        if (hops.is_paper == 0u && rho > 0.0) {
            seen = 0.5 * seen_light(n, cell, rho, power, a, vec3f(1.0));
        }
        gathered[slot] = vec4f(seen, gate);
        gathered[slot + 1u] = vec4f(0.0);
        gathered[slot + 2u] = vec4f(0.0);
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = id.y;
    // A grid may have more columns than begin together.
    if (n >= hops.grids || id.x >= hops.columns) {
        return;
    }
    let columns = grids[n].count.x * grids[n].count.y;
    var k = id.x;
    if (k >= columns) {
        return;
    }
    loop {
        begin_column(n, k);
        k += hops.columns;
        if (k >= columns) {
            break;
        }
    }
}
