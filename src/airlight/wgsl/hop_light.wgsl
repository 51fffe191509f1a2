//! use delta_beam
//! use hop_grid
//! use phase

// What a cell's light is and sends out; see maths/ordinate_hops.py. The including pass binds what
// hop_grid wants, `hops` (HopParams), `states_out` and `gathered` (array<vec4f>).

const LARGEST_A = 0.999;

// What leaves a cell ahead, to each side and behind, W, and the mean cosine of all of it.
struct Outflow {
    ahead: vec3f,
    side: vec3f,
    behind: vec3f,
    a: vec3f,
}

fn hop_slot(n: u32, index: u32) -> u32 {
    return 3u * (n * hops.capacity + index);
}

// `gate`: share of light along the grid's own that surfaces between this cell and the one before let
// through, in both directions.
fn send_out(slot: u32, power: vec3f, a: vec3f, gate: f32) {
    let r = cap_fractions(a.r);
    let g = cap_fractions(a.g);
    let b = cap_fractions(a.b);
    states_out[slot] = vec4f(power * vec3f(r.x, g.x, b.x), a.r);
    states_out[slot + 1u] = vec4f(power * vec3f(r.y, g.y, b.y), a.g);
    states_out[slot + 2u] = vec4f(gate * power * vec3f(r.z, g.z, b.z), a.b);
}

const ISOTROPIC_PATH = 0.674;

// How long the path of a lobe's light is, in hops; see maths/ordinate_hops.py.
fn straight_path(n: u32, a: vec3f) -> vec3f {
    if (hops.is_paper == 1u || grids[n].is_radial == 1u) {
        return vec3f(1.0);
    }
    let b = min(abs(a), vec3f(1.0));
    let b2 = b * b;
    return 1.0 - (1.0 - ISOTROPIC_PATH) * pow(1.0 - b2 * b2 * b, vec3f(0.65));
}

// Mean of exp(-x t) over t = 0..1.
fn mean_on_path(x: vec3f) -> vec3f {
    let safe = max(x, vec3f(1e-3));
    return select(1.0 - 0.5 * x, (1.0 - exp(-safe)) / safe, x > vec3f(1e-3));
}

// In-scattered radiance towards the eye, per unit scattering coefficient, on a path of `steps` hops.
fn seen_light(n: u32, cell: vec3u, rho: f32, power: vec3f, a: vec3f, steps: vec3f) -> vec3f {
    let path = hop_path(n, cell.z) * steps;
    let point = hop_point(n, vec3f(cell) + 0.5);
    let absorbed = rho * params.sigma_t * (1.0 - params.albedo) * path;
    let light = mean_on_path(absorbed) * power * path / hop_volume(n, cell);
    let mu = clamp(dot(hop_travel(n, point), normalize(hops.eye - point)), -1.0, 1.0);
    let lobe = select(a * params.g, a, hops.is_paper == 1u);
    let sharpest = select(min(resolved_by(grids[n].mean_cosine), LARGEST_A), LARGEST_A,
        hops.is_paper == 1u);
    return light * henyey_greenstein_rgb(mu, min(lobe, vec3f(sharpest)));
}
