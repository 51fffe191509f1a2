// A beam that keeps part of what it scatters; see maths/delta_beam.py. One value per channel.

fn forward_share(g: vec3f) -> vec3f {
    let k = max(g, vec3f(0.0));
    return k * sqrt(k);
}

fn deposited_anisotropy(g: vec3f) -> vec3f {
    let f = forward_share(g);
    return (g - f) / (1.0 - f);
}

fn beam_loss(g: vec3f, albedo: vec3f) -> vec3f {
    return 1.0 - albedo * forward_share(g);
}

fn quasi_forward_anisotropy(g: vec3f, albedo: vec3f, tau: vec3f) -> vec3f {
    return forward_cosine(forward_share(g) * albedo * tau, (1.0 + 2.0 * g) / 3.0);
}

// After m forward scatterings in the mean, at least one, of which each keeps a share of direction.
fn forward_cosine(m: vec3f, cosine: vec3f) -> vec3f {
    let small = m < vec3f(0.01);
    let safe = select(m, vec3f(1.0), small);
    let none = exp(-safe);
    let exact = (exp(-safe * (1.0 - cosine)) - none) / (1.0 - none);
    return select(exact, cosine * (1.0 - 0.5 * m * (1.0 - cosine)), small);
}

// Of diffuse light, what leaves the medium or is absorbed before it is turned; see maths/delta_beam.py, unturned.
// `turning`: scattering that turns, `either`: that and absorption, in the mean; m^-1.
fn unturned_share(turning: vec3f, either: vec3f, largest_diffusivity: f32) -> vec3f {
    let depth = 4.5 * largest_diffusivity * either;
    return 1.0 - turning / max(either, vec3f(1e-30)) * (1.0 - exp(-depth * depth));
}

const RIPPLE = 0.05;

// The sharpest lobe that ordinates as narrow as `mean_cosine` sum up without spots; see
// maths/delta_beam.py.
fn resolved_by(mean_cosine: f32) -> f32 {
    return pow(RIPPLE, sqrt(max(1.0 - mean_cosine, 0.0)));
}
