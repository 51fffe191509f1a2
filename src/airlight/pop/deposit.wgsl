//! use medium_grid
//! use ordinate_grid
//! use delta_beam
//! use medium

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    let centre = cell_centre(cell_of(id.x));
    let loss = beam_loss(params.g, params.albedo);
    let share = params.albedo * (1.0 - forward_share(params.g));
    let volume = params.cell.x * params.cell.y * params.cell.z;
    var power = vec3f(0.0);
    var x = vec3f(0.0);
    var y = vec3f(0.0);
    var z = vec3f(0.0);
    for (var n = 0u; n < params.ordinate_count; n++) {
        let o = ordinates[n];
        if (all(o.irradiance.rgb <= vec3f(0.0))) {
            continue;
        }
        let d = o.direction.xyz;
        let half = 0.5 * o.irradiance.w * d;
        let before = passed_at(n, ordinate_place(n, centre - half));
        let after = passed_at(n, ordinate_place(n, centre + half));
        let k = loss * params.sigma_t;
        let inside = max(after - before, 0.0);
        // (1 - exp(-k inside))/loss, without cancellation in thin air
        let lost = exp(-k * before) * mean_transmittance_rgb(k * inside) * params.sigma_t * inside;
        let s = o.irradiance.rgb * lost * share * (volume / o.irradiance.w);
        let carried = s * o.cell.w;
        power += s;
        x += carried * d.x;
        y += carried * d.y;
        z += carried * d.z;
    }
    let g1 = deposited_anisotropy(params.g);
    deposits[id.x] = vec4f(power, 0.0);
    deposits[id.x + params.cells] = vec4f(g1 * x, 0.0);
    deposits[id.x + 2u * params.cells] = vec4f(g1 * y, 0.0);
    deposits[id.x + 3u * params.cells] = vec4f(g1 * z, 0.0);
}
