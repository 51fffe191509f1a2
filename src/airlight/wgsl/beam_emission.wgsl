//! use arriving_light
//! use beam_light
//! use delta_beam
//! use inner_share
//! use phase
//! needs fn quasi_forward_cosine(n: u32, cell: u32) -> vec3f
//! needs fn reduced_depth(n: u32, cell: u32) -> vec3f
//! needs fn true_depth(n: u32, cell: u32) -> vec3f

// Light that a medium scatters; see maths/delta_beam.py, Solution.emission. The including pass
// binds params, ordinates, passed, `phase` (tables of PHASE_TABLE entries) and `diffuse`
// (as pop/delta/diffuse.py and outgoing.py say).

const PHASE_TABLE = 256u;

struct BeamEmission {
    beams: vec3f,          // of directional lights
    local: vec3f,          // of local ones
    sky: vec3f,            // the same of the sky's ordinates
    quasi_forward: vec3f,
    fluence: vec3f,        // W m^-2, of the beams, the local and the sky
    quasi_fluence: vec3f,  // of the quasi-forward
    inner: vec3f,          // both, of local lights in the medium or near it
}

// How far an ordinate is a local light in the medium or near it.
fn local_share(n: u32) -> f32 {
    let position = ordinates[n].position;
    return select(0.0, inner_share(position.xyz, params.extent, 3.0 * params.largest_diffusivity),
        position.w == LOCAL);
}

// Mean cosine of the directions from which a local light that is spread over `spread`, m, comes to the points of a cell
// `distance` away; see maths/point_light_beam.py.
fn local_sharpness(spread: f32, distance: f32) -> f32 {
    let apart = spread * spread + dot(params.cell, params.cell) / 12.0;
    return distance * inverseSqrt(distance * distance + apart);
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
        // Scattered once: what has passed the medium unscattered, by kind of light.
        let mu = clamp(dot(light.travel, travel), -1.0, 1.0);
        let direct = exp(-true_depth(n, cell));
        sum.fluence += light.irradiance * direct;
        let once = light.irradiance * direct * beam_phase(n, mu);
        var sharpness = 1.0;
        if (ordinates[n].position.w == LOCAL) {
            sharpness = local_sharpness(ordinates[n].irradiance.w, light.distance);
            sum.local += light.irradiance * direct * henyey_greenstein_rgb(mu, sharpness * params.g);
        } else if (ordinates[n].spot.w == 0.0) {
            sum.beams += once;
        } else {
            sum.sky += once;
        }
        // Scattered forwards on its way: what the reduced medium passes more, widened as often as it was scattered.
        let quasi = select(exp(-reduced_depth(n, cell)) - direct, vec3f(0.0),
            ordinates[n].position.w == VIRTUAL_GRID);
        sum.quasi_fluence += light.irradiance * quasi;
        sum.inner += local_share(n) * light.irradiance * (direct + quasi);
        let a = quasi_forward_cosine(n, cell);
        let sharpest = resolved_by(ordinates[n].direction.w);
        let lobe = params.g * a * ordinates[n].direction.w * sharpness;
        sum.quasi_forward += light.irradiance * quasi
            * henyey_greenstein_rgb(mu, min(lobe, vec3f(sharpest)));
    }
    return sum;
}

// Diffuse light that the medium itself scatters: the peak of its phase function what arrives, the rest what is there.
fn diffuse_emission(cell: u32, travel: vec3f) -> vec3f {
    let kept = forward_share(params.g);
    let smooth_part = diffuse[6u * params.cells + cell].xyz;
    if (all(kept <= vec3f(0.0))) {
        return smooth_part;
    }
    return smooth_part + kept * arriving(cell, travel);
}
