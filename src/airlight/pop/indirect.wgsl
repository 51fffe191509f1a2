// Indirect light of surfaces that a cell scatters towards the eye, per unit scattering coefficient:
// the radiance of the lattice there, times the share that reaches the cell.
//! use medium_grid
//! use phase
//! use lattice
//! needs fn reduced_depth(n: u32, cell: u32) -> vec3f

// The mean radiance in a cell under a uniform sky of radiance 1; see maths/delta_beam.py, fluence.
fn uniform_radiance(cell: u32) -> vec3f {
    if (reflected.is_whole != 0u) {
        return vec3f(1.0);
    }
    var fluence = diffuse[cell].xyz;
    for (var n = 0u; n < params.ordinate_count; n++) {
        fluence += ordinates[n].irradiance.rgb * exp(-reduced_depth(n, cell));
    }
    return clamp(fluence * PHASE_ISOTROPIC, vec3f(0.0), vec3f(1.0));
}

// Scattered radiance of a two-band state: the phase function keeps g of its direction.
fn scattered_radiance(state: vec4f, travel: vec3f, g: f32) -> f32 {
    return max(0.0, state.x + reflected.direct * g * dot(state.yzw, travel));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || reach[id.x] == 0u) {
        return;
    }
    // The cell, and the direction to the eye, in the world.
    let centre = cell_centre(cell_of(id.x));
    let p = (params.world_from_medium * vec4f(centre, 1.0)).xyz;
    let to_eye = normalize(reflected.eye - centre + vec3f(1e-12));
    let towards = (params.world_from_medium * vec4f(to_eye, 0.0)).xyz;
    // Of nested lattices each takes over from the finer ones where those end.
    let last = arrayLength(&lattices) - 1u;
    var light = vec3f(0.0);
    var left = 1.0;
    for (var k = 0u; k <= last && left > 0.0; k++) {
        let lattice = lattices[k];
        let share = left * lattice_weight(lattice, p);
        if (share > 0.0) {
            // A cell's power over that of the largest lattice, where both hold the same light.
            let finer = lattices[last].cell / lattice.cell;
            let travel = lattice_from_world(lattice, towards);
            let uvw = coordinates_in_medium(lattice, p);
            let red = textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0);
            let green = textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0);
            let blue = textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0);
            light += share * finer * finer * vec3f(
                scattered_radiance(red, travel, params.g.r),
                scattered_radiance(green, travel, params.g.g),
                scattered_radiance(blue, travel, params.g.b));
            left -= share;
        }
    }
    light *= reflected.scale * uniform_radiance(id.x);
    indirect[id.x] = vec4f(light, 0.0);
}
