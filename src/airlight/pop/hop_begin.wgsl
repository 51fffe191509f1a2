//! use hop_light

// Share of an ordinate's light that surfaces let through to a point, by the medium's cell there.
fn lit_at(n: u32, point: vec3f) -> f32 {
    let cell = vec3u(clamp(point / params.cell, vec3f(0.0), vec3f(params.count) - 1.0));
    let index = (cell.z * params.count.y + cell.y) * params.count.x + cell.x;
    return passed[(params.ordinate_count + n) * params.cells + index];
}

// Irradiance before the air takes any, W m^-2 in units of the table's scale, times a cell's section.
fn entering(n: u32, cell: vec3u) -> vec3f {
    let o = ordinates[n];
    let g = grids[n];
    let section = g.cell * g.cell;
    let point = hop_point(n, vec3f(cell) + 0.5);
    let lit = lit_at(n, point);
    if (o.position.w == 0.0) {
        return o.irradiance.rgb * section * lit;
    }
    let away = point - o.position.xyz;
    let r = max(length(away), 1e-9);
    let fade = smoothstep(o.spot.y, o.spot.x, dot(away / r, o.direction.xyz));
    let across = select(section / (r * r), solid_angles[cell.y * g.count.x + cell.x],
        g.is_radial == 1u);
    return o.irradiance.rgb * fade * across * lit;
}

// One column of a grid, along its light.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = id.y;
    if (n >= params.ordinate_count || id.x >= grids[n].count.x * grids[n].count.y) {
        return;
    }
    let a = vec3f(grids[n].mean_cosine)
        * select(params.g, vec3f(1.0), hops.is_paper == 1u);
    var tau = vec3f(0.0);
    for (var z = 0u; z < grids[n].count.z; z++) {
        var cell = hop_cell(n, id.x);
        cell.z = z;
        let index = hop_index(n, cell);
        let slot = hop_slot(n, index);
        let rho = hop_rho[n * hops.capacity + index];
        let depth = rho * params.sigma_t * hop_path(n, z);
        var power = entering(n, cell);
        if (hops.is_paper == 1u) {
            power *= exp(-(tau + 0.5 * depth));
        } else {
            power *= params.albedo * (exp(-tau) - exp(-(tau + depth)));
        }
        tau += depth;
        send_out(slot, power, a);
        var seen = vec3f(0.0);
        if (hops.is_paper == 0u && rho > 0.0) {
            seen = 0.5 * seen_light(n, cell, rho, power, a, vec3f(1.0));
        }
        gathered[slot] = vec4f(seen, 0.0);
        gathered[slot + 1u] = vec4f(0.0);
        gathered[slot + 2u] = vec4f(0.0);
    }
}
