//! use lattice

// Light along a mirrored ray: the lattice's cells are walked until blockers stop the ray, or its
// lobe is wider than cells tell apart.
// Source: Kaplanyan2010 section 7 and Fig. 8 (right), where the ray averages the intensity of the
// four cells it passes, divided by squared distance.
// differs: what arrives is the light of the cells before the faces that stop the ray; the average
// of all cells passed shows the light before a wall as much as the wall.

const GLOSSY_CELLS = 32u;           // faces crossed at most
const GLOSSY_LEAST_LEFT = 0.02;     // transmittance that counts as none, and ends a ray
const GLOSSY_REACH = 0.75;          // cells times alpha: where the lobe is some three cells wide
const GLOSSY_START = 0.25;          // cells above the surface
const GLOSSY_OWN = 2.0;             // closed share of a face per projected area, with a margin
const GLOSSY_BORDER = 6.0;          // cells before the lattice's border where its light fades out:
                                    // nothing comes in there, which two bands cannot tell

struct Glossy {
    irradiance: vec3f,  // W m^-2, pi times the radiance of what stops the ray
    left: f32,          // share of the ray that nothing stopped, through which the sky is seen
    lit: f32,           // share of the lattice's light at its end that arrives
    uvw: vec3f,         // where it ends, texture coordinates of the lattice
    end: f32,           // the same, cells from its start
    is_cut: bool,       // whether it would go on in a larger lattice
}

struct GlossyRay {
    n: vec3f,           // the surface's normal
    r: vec3f,           // the mirrored direction
    alpha: f32,
    raised: f32,        // cells above the surface at which it starts
}

// The open share of the low face of `cell` across axis 0, 1 or 2, where a ray crosses it at `coordinates`.
// Interpolated in the face's plane, so that images of partly open cells have no edges.
fn glossy_open(lattice: LatticeParams, cell: f32, coordinates: vec3f, axis: u32) -> f32 {
    var at = coordinates;
    at[axis] = cell + 0.5;
    let low = textureSampleLevel(lattice_visibility_b, linear_clamp, lattice_uvw(lattice, at), 0.0);
    return select(select(low.x, low.w, axis == 1u), low.z, axis == 0u);
}

// How much of a closed face that a ray crosses `height` cells above its own surface is that
// surface: a slanted one blocks rays along it, in steps as large as cells.
fn glossy_own(n: vec3f, towards: vec3f, axis: u32, height: f32) -> f32 {
    let against = max(0.0, -n[axis] * towards[axis]);
    return GLOSSY_OWN * against * (1.0 - smoothstep(0.75, 1.75, height));
}

// No lower over the surface than where that looks its own light up.
fn glossy_raised(coordinates: vec3f, lookup: vec3f, n: vec3f) -> vec3f {
    return coordinates + n * max(0.0, dot(lookup - coordinates, n));
}

fn glossy_begun() -> Glossy {
    return Glossy(vec3f(0.0), 1.0, 1.0, vec3f(0.0), 0.0, true);
}

// Which face a ray crosses next.
struct Crossing {
    axis: u32,
    t: f32,             // where, cells from its start
    is_inside: bool,    // of the lattice, and before the ray's end
}

fn next_crossing(crossing: vec3f, cell: vec3f, towards: vec3f, count: vec3f, reach: f32) -> Crossing {
    var axis = select(0u, 1u, crossing.y < crossing.x);
    axis = select(axis, 2u, crossing.z < crossing[axis]);
    let t = crossing[axis];
    let next = cell[axis] + towards[axis];
    return Crossing(axis, t, t < reach && next >= 0.0 && next < count[axis]);
}

// The same, from where `before` (of a finer lattice, its end in cells of this one) ended. Two loops:
// light is looked up only where a face took some of it. Both end with their test, after which
// CPU adapters run nothing.
fn glossy_walk(
    lattice: LatticeParams, surface: vec3f, lookup: vec3f, ray: GlossyRay, before: Glossy,
    is_outermost: bool,
) -> Glossy {
    // From face to face (a digital differential analyser), in cells.
    let n = ray.n;
    let r = ray.r;
    let start = surface + ray.raised * n;
    let count = vec3f(lattice.count);
    let towards = select(vec3f(-1.0), vec3f(1.0), r > vec3f(0.0));
    let per_cell = 1.0 / max(abs(r), vec3f(1e-6));
    var cell = clamp(floor(start + before.end * r), vec3f(0.0), count - 1.0);
    var crossing = ((cell + max(towards, vec3f(0.0))) - start) * towards * per_cell;
    // Ends where every ray is sure to come: its number of crossings jumps from pixel to pixel.
    let widest = GLOSSY_REACH / ray.alpha;
    let reach = min(widest, before.end + f32(GLOSSY_CELLS - 3u) / dot(abs(r), vec3f(1.0)));
    // Where closed faces stop a share of the ray, it sees the cells before them; the rest goes on.
    var left = before.left;
    var transmittance = mix(GLOSSY_LEAST_LEFT, 1.0, left);
    var irradiance = before.irradiance;
    var next = next_crossing(crossing, cell, towards, count, reach);
    var goes = next.is_inside && left > 0.0;
    var t = next.t;
    var i = 0u;
    loop {
        var lost = 0.0;
        var seen = start;
        loop {
            // The face that the ray crosses next; its own surface does not close it.
            let axis = next.axis;
            let coordinates = start + next.t * r;
            let own = glossy_own(n, towards, axis, dot(coordinates - surface, n));
            let face = max(cell[axis], cell[axis] + towards[axis]);
            let open = min(1.0, glossy_open(lattice, face, coordinates, axis) + own);
            if (goes) {
                transmittance *= open;
                let passing = saturate((transmittance - GLOSSY_LEAST_LEFT) / (1.0 - GLOSSY_LEAST_LEFT));
                lost = left - passing;
                left = passing;
                seen = coordinates;
                seen[axis] = cell[axis] + 0.5;
                cell[axis] += towards[axis];
                crossing[axis] += per_cell[axis];
                i++;
                next = next_crossing(crossing, cell, towards, count, reach);
                goes = next.is_inside && left > 0.0 && i < GLOSSY_CELLS;
                t = select(t, next.t, left > 0.0);
            }
            if (lost > 0.0 || !goes) {
                break;
            }
        }
        // What was stopped sees the cell before the face.
        let uvw = lattice_eased(lattice, glossy_raised(seen, lookup, n), vec3f(0.0));
        irradiance += lost * lattice_irradiance_at(lattice, uvw, r);
        if (!goes) {
            break;
        }
    }
    // The rest sees the cell at its end; beyond the border of the outermost lattice there is none.
    t = min(t, reach);
    let border = select(-start, count - start, r > vec3f(0.0)) * towards * per_cell;
    let inside = saturate((min(border.x, min(border.y, border.z)) - t) / GLOSSY_BORDER);
    let uvw = lattice_eased(lattice, glossy_raised(start + t * r, lookup, n), vec3f(0.0));
    let lit = left * select(1.0, inside, is_outermost);
    return Glossy(irradiance, left, lit, uvw, t, t < widest && left > 0.0);
}
