//! use beam_light
//! use delta_beam
//! use phase
//! needs fn quasi_forward_cosine(n: u32, cell: u32) -> vec3f
//! needs fn reduced_depth(n: u32, cell: u32) -> vec3f
//! needs fn true_depth(n: u32, cell: u32) -> vec3f
//! needs fn unturned() -> vec3f

// Light that a medium scatters; see maths/delta_beam.py, Solution.emission. The including pass
// binds params, ordinates, passed, `phase` (tables of PHASE_TABLE entries) and `diffuse`
// ([Phi, Jx, Jy, Jz] per cell).

const PHASE_TABLE = 256u;
const STRONGEST_FLUX = 0.95;

struct BeamEmission {
    beams: vec3f,          // of directional lights
    local: vec3f,          // of local ones
    sky: vec3f,            // the same of the sky's ordinates
    quasi_forward: vec3f,
    bent_x: vec3f,         // flux that the lobes of quasi_forward lack
    bent_y: vec3f,
    bent_z: vec3f,
}

fn beam_phase(n: u32, mu: f32) -> vec3f {
    let at = sqrt(sqrt(saturate(0.5 - 0.5 * mu))) * f32(PHASE_TABLE - 1u);
    let low = min(u32(at), PHASE_TABLE - 2u);
    let first = n * PHASE_TABLE + low;
    return mix(phase[first].rgb, phase[first + 1u].rgb, at - f32(low));
}

// Per unit scattering coefficient, of all ordinates, in a cell and towards `travel`.
fn beam_emission(cell: u32, travel: vec3f) -> BeamEmission {
    var sum = BeamEmission();
    let point = cell_centre(cell_of(cell));
    for (var n = 0u; n < params.ordinate_count; n++) {
        let light = beam_light(n, cell, point);
        if (all(light.irradiance <= vec3f(0.0))) {
            continue;
        }
        let mu = clamp(dot(light.travel, travel), -1.0, 1.0);
        let direct = exp(-true_depth(n, cell));
        let once = light.irradiance * direct * beam_phase(n, mu);
        if (ordinates[n].position.w == LOCAL) {
            sum.local += once;
        } else if (ordinates[n].spot.w == 0.0) {
            sum.beams += once;
        } else {
            sum.sky += once;
        }
        let quasi = select(exp(-reduced_depth(n, cell)) - direct, vec3f(0.0),
            ordinates[n].position.w == VIRTUAL_GRID);
        let a = quasi_forward_cosine(n, cell);
        let sharpest = resolved_by(ordinates[n].direction.w);
        let lobe = params.g * a * ordinates[n].direction.w;
        sum.quasi_forward += light.irradiance * quasi
            * henyey_greenstein_rgb(mu, min(lobe, vec3f(sharpest)));
        let lost = light.irradiance * quasi * (1.0 - a) * ordinates[n].direction.w;
        sum.bent_x += lost * light.travel.x;
        sum.bent_y += lost * light.travel.y;
        sum.bent_z += lost * light.travel.z;
    }
    return sum;
}

// `beams`: of the same cell; what their lobes lack, diffuse light of a thin medium carries.
fn diffuse_emission(cell: u32, travel: vec3f, beams: BeamEmission) -> vec3f {
    let share = unturned();
    let phi = diffuse[cell].xyz;
    let x = diffuse[cell + params.cells].xyz + share * beams.bent_x;
    let y = diffuse[cell + 2u * params.cells].xyz + share * beams.bent_y;
    let z = diffuse[cell + 3u * params.cells].xyz + share * beams.bent_z;
    let size = sqrt(x * x + y * y + z * z);
    let along = x * travel.x + y * travel.y + z * travel.z;
    let mu = clamp(along / max(size, vec3f(1e-20)), vec3f(-1.0), vec3f(1.0));
    let g = params.g * min(size / max(phi, vec3f(1e-20)), vec3f(STRONGEST_FLUX));
    return phi * vec3f(henyey_greenstein(mu.r, g.r), henyey_greenstein(mu.g, g.g),
        henyey_greenstein(mu.b, g.b));
}
