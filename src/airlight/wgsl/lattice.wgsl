// Reading a solved lattice (Kaplanyan2010 section 3.4). The including pass binds lattice_red/green/blue (filtered 3D textures
// of a, b), lattice_visibility_a/b (the visibility of each cell's six faces in both directions) and linear_clamp, and
// declares the struct LatticeParams.
//! use lattice_space

// How far along the normal to look, in cells, so that light behind a wall is not mixed in: the
// centre of the first cell wholly before the surface's plane, as blockers round it to cell faces.
fn lookup_offset(coordinates: f32, n: f32) -> f32 {
    let f = fract(coordinates * sign(n));
    return n * (0.5 + min(f, 1.0 - f));
}

// The share of a neighbour in interpolation, less where the face between is closed; but what lies in
// a face that is not wholly closed and does not face along it (an arch's soffit) sees both sides.
fn open_fraction(offset: f32, open_low: f32, open_high: f32, rim: f32) -> f32 {
    let open = select(open_low, open_high, offset > 0.0);
    let within = rim * smoothstep(0.0, 0.25, open) * smoothstep(0.5 - BEFORE, 0.5, abs(offset));
    return offset * max(smoothstep(0.15, 0.5, open), within);
}

// How far a surface of normal n is one between what lies on both sides of it; not a point of a medium (n = 0).
fn rim_shares(n: vec3f) -> vec3f {
    return dot(n, n) * (1.0 - smoothstep(vec3f(0.2), vec3f(0.5), abs(n)));
}

// On which axes a step from a cell leads into a wall that encloses it.
fn ends(lattice: LatticeParams, cell: vec3f, step: vec3f) -> vec3<bool> {
    let inside = clamp(cell, vec3f(0.0), vec3f(lattice.count) - 1.0);
    let hops = select(vec3u(1u, 4u, 16u), vec3u(2u, 8u, 32u), step < vec3f(0.0));
    return (vec3u(enclosed_faces(lattice, vec3i(inside))) & hops) != vec3u(0u);
}

// Cells from a wall that a surface stands on, and before a surface, where it is known what it faces:
// lest what is looked up is its own back, or, of the foot of a wall, what is under the floor.
const BEFORE = 0.15;

// The foot of a wall may be a little below the floor in warped coordinates, or its normal's relief
// may lead there. The floor is known half a cell before the wall.
fn lifted(lattice: LatticeParams, coordinates: vec3f, n: vec3f) -> vec3f {
    let is_facing = abs(n) > vec3f(0.5);
    let before = coordinates + select(vec3f(0.0), 0.5 * sign(n), is_facing);
    let cell = floor(before);
    let t = before - cell;
    let side = select(vec3f(0.0), vec3f(1.0), t > vec3f(1.0 - BEFORE))
        - select(vec3f(0.0), vec3f(1.0), t < vec3f(BEFORE));
    // Above the floor or, by the warp, just below it: to a little above.
    let down = select(side, vec3f(0.0), is_facing);
    let is_above = ends(lattice, cell, down);
    let is_below = ends(lattice, cell + down, -down) & !is_above;
    let face = cell + 0.5 + 0.5 * down;
    let up = (BEFORE + 0.01) * select(-down, down, is_below);
    return select(coordinates, face + up, (is_above | is_below) & (down != vec3f(0.0)));
}

// Where it is wanted to look, but on no axis past the middle of a cell that a surface at `coordinates` faces, where
// a wall on that axis encloses the cell.
fn before_walls(lattice: LatticeParams, coordinates: vec3f, wanted: vec3f, n: vec3f) -> vec3f {
    let cell = floor(coordinates + BEFORE * n);
    let centre = cell + 0.5;
    let within = select(min(wanted, centre), max(wanted, centre), n < vec3f(0.0));
    return select(wanted, within, ends(lattice, cell, n));
}

// Where to look for the light on a surface, in warped coordinates as `warped` itself. Not behind a wall that the
// surface faces: the underside of a ball would be looked up beneath the floor that it lies on.
fn lookup_coordinates(lattice: LatticeParams, warped: vec3f, n: vec3f) -> vec3f {
    let coordinates = lifted(lattice, warped, n);
    let wanted = coordinates + vec3f(lookup_offset(coordinates.x, n.x), lookup_offset(coordinates.y, n.y),
        lookup_offset(coordinates.z, n.z));
    return before_walls(lattice, coordinates, wanted, n);
}

// Texture coordinates of lattice coordinates; none between two lattices that share textures.
fn lattice_uvw(lattice: LatticeParams, coordinates: vec3f) -> vec3f {
    let inside = clamp(coordinates, vec3f(0.5), vec3f(lattice.count) - 0.5);
    return (inside + vec3f(0.0, f32(lattice.first_row), 0.0))
        / vec3f(textureDimensions(lattice_red));
}

// Texture coordinates some cells farther.
fn lattice_moved(lattice: LatticeParams, uvw: vec3f, cells: vec3f) -> vec3f {
    let size = vec3f(textureDimensions(lattice_red));
    let first = vec3f(0.5, f32(lattice.first_row) + 0.5, 0.5);
    return clamp(uvw * size + cells, first, first + vec3f(lattice.count) - 1.0) / size;
}

// Where to interpolate in a cell that is t, -1/2 to 1/2, from its middle: not across closed faces.
fn open_offset(lattice: LatticeParams, cell: vec3f, t: vec3f, rim: vec3f) -> vec3f {
    let xy = textureLoad(lattice_visibility_a, lattice_texel(lattice, vec3i(cell)), 0);
    let z = textureLoad(lattice_visibility_b, lattice_texel(lattice, vec3i(cell)), 0);
    // Hop 0 comes from the low x side, hop 1 from the high, and so on.
    return vec3f(open_fraction(t.x, xy.x, xy.y, rim.x), open_fraction(t.y, xy.z, xy.w, rim.y),
        open_fraction(t.z, z.x, z.y, rim.z));
}

// Texture coordinates at which lattice coordinates are sampled, not across closed faces; `rim` as from
// rim_shares, 0 for rays.
fn lattice_eased(lattice: LatticeParams, coordinates: vec3f, rim: vec3f) -> vec3f {
    let count = vec3f(lattice.count);
    let cell = clamp(floor(coordinates), vec3f(0.0), count - 1.0);
    let t = clamp(coordinates - cell, vec3f(0.0), vec3f(1.0)) - 0.5;
    let eased = open_offset(lattice, cell, t, rim);
    return lattice_uvw(lattice, cell + 0.5 + eased);
}

// The same for a point of a medium of the world, m.
fn coordinates_in_medium(lattice: LatticeParams, position: vec3f) -> vec3f {
    let warped = warped_lookup(lattice, position, vec3f(0.0));
    return lattice_eased(lattice, lookup_coordinates(lattice, warped, vec3f(0.0)), vec3f(0.0));
}

// pi l/s^2 times this is the irradiance on a surface of normal n in the cell. Two bands of light
// that travels in one direction are negative behind: beyond what fills half of all directions, the rest is
// read as a beam, and some light is left behind it (twin: maths.lattice6.surface_irradiance).
const LEAST_BEHIND = 0.3;

fn facing_flux(state: vec4f, n: vec3f) -> f32 {
    let a = max(state.x, 0.0);
    let b = length(state.yzw);
    let along = dot(state.yzw, n) / max(b, 1e-20);
    let r = min(b / max(3.0 * a, 1e-20), 1.0);
    let beam = max(2.0 * r - 1.0, 0.0);
    let flux = mix(1.0 - min(2.0 * r, 1.0) * along, 4.0 * max(-along, 0.0), beam);
    return a * max(flux, LEAST_BEHIND * (1.0 - r) / (1.0 + r));
}

// The paper's rule: the intensity towards the surface from half a cell away.
fn facing_flux_paper(state: vec4f, n: vec3f) -> f32 {
    return 4.0 / 3.14159265 * max(0.0, state.x - dot(state.yzw, n));
}

fn facing(lattice: LatticeParams, state: vec4f, n: vec3f) -> f32 {
    if (lattice.is_paper != 0u) {
        return facing_flux_paper(state, n);
    }
    return lattice.lookup_scale * facing_flux(state, n);
}

// Irradiance, W m^-2, on a surface of normal n at texture coordinates.
fn lattice_irradiance_at(lattice: LatticeParams, uvw: vec3f, n: vec3f) -> vec3f {
    let flux = vec3f(
        facing(lattice, textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0), n),
        facing(lattice, textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0), n),
        facing(lattice, textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0), n));
    let scale = 3.14159265 / (lattice.cell * lattice.cell * lattice.power_scale);
    return flux * scale;
}

// A narrow gap may put a surface into a cell that no light reaches, black beside a lit wall: then a
// share of what the next cell before it holds is nearer to the truth.
const CREVICE_SHARE = 0.5;

fn lattice_irradiance(lattice: LatticeParams, uvw: vec3f, n: vec3f) -> vec3f {
    let here = lattice_irradiance_at(lattice, uvw, n);
    let next = lattice_irradiance_at(lattice, lattice_moved(lattice, uvw, n), n);
    return max(here, CREVICE_SHARE * next);
}

// Intensities of all channels together, stored units.
fn lattice_grey(uvw: vec3f) -> vec4f {
    return textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0)
        + textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0)
        + textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0);
}

// 1, or less where the light falls off away from the surface: it then comes from behind it.
// Source: Kaplanyan2010 section 3.4 and Fig. 3, which leaves the formula open; here the derivative
// along the normal, per cell, as far as it points against the light, times `strength`.
fn lattice_damping(lattice: LatticeParams, uvw: vec3f, n: vec3f, strength: f32) -> f32 {
    let here = lattice_grey(uvw);
    let change = lattice_grey(lattice_moved(lattice, uvw, 0.5 * n))
        - lattice_grey(lattice_moved(lattice, uvw, -0.5 * n));
    return saturate(1.0 + strength * dot(change, here) / max(dot(here, here), 1e-20));
}
