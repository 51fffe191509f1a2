// The light of an endless medium beyond the lattices, from its table over depth; see
// media/march/half_space.py. It is the scene's own medium, the first of all media. The including
// pass binds `half_space` (vec4f) and what march.wgsl does, and declares HALF_SPACE_SIDE, _ROWS and
// _LAST.
//! use octahedron
//! use march_lattice
//! use medium
//! needs fn half_space_forward(p: vec3f, travel: vec3f) -> vec3f

// The share of a step's middle that no lattice holds.
fn outside_lattices() -> f32 {
    var left = 1.0;
    for (var i = 0u; i < LATTICES_AT_ONCE; i++) { left -= lattice_at[i].w; }
    return saturate(left);
}

fn inside_lattices() -> f32 { return 1.0 - outside_lattices(); }

// The row above the depth of a point, and the fraction to the next.
fn half_space_row(p: vec3f) -> vec2f {
    let depth = own.half_space_sigma_t * max(own.half_space_top - p.y, 0.0);
    let row = min(depth / (1.0 + depth) / HALF_SPACE_LAST, 1.0) * f32(HALF_SPACE_ROWS - 1u);
    let i = min(floor(row), f32(HALF_SPACE_ROWS - 2u));
    return vec2f(i, row - i);
}

const HALF_SPACE_ROW = 2u + HALF_SPACE_SIDE * HALF_SPACE_SIDE;

fn half_space_column(column: u32, row: vec2f) -> vec3f {
    let first = u32(row.x) * HALF_SPACE_ROW + column;
    return mix(half_space[first].rgb, half_space[first + HALF_SPACE_ROW].rgb, row.y);
}

// Bilinear between directions; `at`: texels of the octahedron's square.
fn half_space_towards(row: vec2f, at: vec2f) -> vec3f {
    if (HALF_SPACE_SIDE == 1u) { return half_space_column(2u, row); }
    let low = min(vec2u(at), vec2u(HALF_SPACE_SIDE - 2u));
    let f = at - vec2f(low);
    let first = 2u + low.y * HALF_SPACE_SIDE + low.x;
    return mix(
        mix(half_space_column(first, row), half_space_column(first + 1u, row), f.x),
        mix(half_space_column(first + HALF_SPACE_SIDE, row),
            half_space_column(first + HALF_SPACE_SIDE + 1u, row), f.x),
        f.y);
}

// Emission of multiple scattering, W m^-3 sr^-1.
fn half_space_emission(p: vec3f, travel: vec3f) -> vec3f {
    let light = media_reduced_sigma_s[0] * half_space_column(0u, half_space_row(p))
        + half_space_forward(p, travel);
    return outside_lattices() * media_density_here[0] * light;
}

var<private> half_space_sky: vec3f;

// What the reduced medium would scatter of the sky, at the point of the last half_space_skylit.
fn half_space_sky_reduced() -> vec3f { return half_space_sky; }

// Emission of single scattering of the sky, W m^-3 sr^-1.
fn half_space_skylit(p: vec3f, travel: vec3f) -> vec3f {
    let row = half_space_row(p);
    let at = (0.5 * octahedron_encode(travel) + 0.5) * f32(HALF_SPACE_SIDE - 1u);
    let here = outside_lattices() * media_density_here[0];
    half_space_sky = here * media_reduced_sigma_s[0] * half_space_column(1u, row);
    return here * media_lit_scattering[0] * half_space_towards(row, at);
}

// Where the ray is in the largest lattice.
fn lattice_interval(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f {
    let last = lattices[arrayLength(&lattices) - 1u];
    let span = ray_box_interval(origin, direction, last.fade_low, last.fade_high);
    let inside = clamp(span, vec2f(hull.x), vec2f(hull.y));
    return select(vec2f(hull.y), inside, inside.x < inside.y);
}

// The length of a step from t on: `near` in the lattice, a share of an optical depth beyond it.
fn step_length(t: f32, lattice: vec2f, near: f32) -> f32 {
    let far = 0.25 / own.half_space_sigma_t;
    let before = min(far, max(lattice.x - t, 1e-4));
    let inside = select(max(near, far), min(near, max(lattice.y - t, 1e-4)), t < lattice.y);
    return select(inside, before, t < lattice.x);
}
