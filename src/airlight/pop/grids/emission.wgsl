// The radiance that a cell scatters towards the eye: of lobes in the grids, of the residuum, and
// (not as printed) of beams.
//! use beam_emission
//! use sky_gain
//! use store_emission

const RESIDUAL_LOBE = 0.5;

// The radiance of the residuum; see maths/ordinate_hops.py, residual_emission.
fn residual_emission(cell: u32, travel: vec3f) -> vec3f {
    let phi = diffuse[cell].xyz;
    let along = diffuse[cell + params.cells].xyz * travel.x
        + diffuse[cell + 2u * params.cells].xyz * travel.y
        + diffuse[cell + 3u * params.cells].xyz * travel.z;
    let shown = phi + 3.0 * RESIDUAL_LOBE * params.g * along;
    return max(0.1 * phi, shown) * PHASE_ISOTROPIC;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    let cell = cell_of(id.x);
    let travel = normalize(hops.eye - cell_centre(cell) + vec3f(1e-12));
    // Lobes of all grids, merged, and the residuum.
    var light = merged[id.x].xyz + residual_emission(id.x, travel);
    var local = vec3f(0.0);
    // Not as printed: light scattered once comes from beams, which no grid blurs.
    if (hops.is_paper == 0u && reach[id.x] != 0u) {
        let beams = beam_emission(id.x, travel);
        light += beams.beams + beams.sky * sky_correction_towards(travel);
        local = beams.local;
    }
    store_emission(cell, light, local);
}
