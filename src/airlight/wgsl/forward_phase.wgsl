// Light scattered forwards before, that is scattered again; see maths/forward_phase.py.
//! use phase

const FORWARD_LEAST_KEPT = 0.02;

fn forward_scatterings(depth: f32) -> f32 {
    let small = abs(depth) < 1e-2;
    let safe = select(depth, 1.0, small);
    return select(safe / (1.0 - exp(-safe)), 1.0 + 0.5 * depth * (1.0 + depth / 6.0), small);
}

fn forward_phase(mu: f32, g: f32, scatterings: f32) -> f32 {
    let kept = pow(max(g, 1e-6), scatterings);
    if (kept < FORWARD_LEAST_KEPT) {
        return max(0.0, PHASE_ISOTROPIC * (1.0 + 3.0 * g * mu));
    }
    return max(0.0, (henyey_greenstein(mu, g * kept) - (1.0 - kept) * PHASE_ISOTROPIC) / kept);
}
