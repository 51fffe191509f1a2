// Henyey-Greenstein of travel directions, sr^-1; sources in maths/phase.py.

const PHASE_ISOTROPIC = 0.07957747154594767;
const PHASE_HALF_OCTANT_COSINE = 0.7071067811865476;

// sqrt(1 + g^2 - 2 g mu) without cancellation.
fn phase_reach(mu: f32, g: f32) -> f32 {
    let mirrored = select(mu, -mu, g < 0.0);
    let h = abs(g);
    return sqrt((1.0 - h) * (1.0 - h) + 2.0 * h * (1.0 - mirrored));
}

fn henyey_greenstein(mu: f32, g: f32) -> f32 {
    let r = phase_reach(mu, g);
    return PHASE_ISOTROPIC * (1.0 - g) * (1.0 + g) / (r * r * r);
}

// One g per colour channel.
fn henyey_greenstein_rgb(mu: f32, g: vec3f) -> vec3f {
    return vec3f(
        henyey_greenstein(mu, g.r),
        henyey_greenstein(mu, g.g),
        henyey_greenstein(mu, g.b),
    );
}

fn henyey_greenstein_cumulative(mu: f32, g: f32) -> f32 {
    let r = phase_reach(mu, g);
    if (r <= 0.0) {
        return 1.0;
    }
    return (1.0 - g) * (1.0 + mu) / (r * (1.0 + g + r));
}

// (front, side, back); front + 4 side + back = 1.
fn cap_fractions(g: f32) -> vec3f {
    let back = henyey_greenstein_cumulative(-PHASE_HALF_OCTANT_COSINE, g);
    let side = (henyey_greenstein_cumulative(PHASE_HALF_OCTANT_COSINE, g) - back) / 4.0;
    return vec3f(1.0 - 4.0 * side - back, side, back);
}

// The phase function of media, per colour channel: what single scattering calls. Its twin is
// maths.phase.scattering_phase; another phase function is written here and there alone.
fn scattering_phase(mu: f32, g: vec3f) -> vec3f {
    return henyey_greenstein_rgb(mu, g);
}
