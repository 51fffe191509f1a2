//! use lattice

// Light along a mirrored ray: the lattice's cells are walked until blockers stop the ray, or its
// lobe is wider than cells tell apart.
// Source: Kaplanyan2010 section 7 and Fig. 8 (right), where the ray averages the intensity of the
// four cells it passes, divided by squared distance.
// differs: what arrives is the light of the cells before the faces that stop the ray; the average
// of all cells passed shows the air before a wall as much as the wall.

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

// How much of what a surface mirrors deserves a ray: none where it is rough or hardly mirrors.
fn glossy_share(specular_albedo: vec3f, roughness: f32) -> f32 {
    let gain = max(specular_albedo.x, max(specular_albedo.y, specular_albedo.z));
    return smoothstep(0.03, 0.08, gain * (1.0 - roughness));
}

// The open share of the face through which a ray enters `cell` at `place`, along axis 0, 1 or 2.
// Interpolated in the face's plane, so that pictures of partly open cells have no edges.
fn glossy_open(lattice: LatticeParams, cell: vec3f, place: vec3f, axis: u32, forward: bool) -> f32 {
    var at = place;
    at[axis] = cell[axis] + 0.5;
    let uvw = lattice_uvw(lattice, at);
    if (axis == 2u) {
        let z = textureSampleLevel(lattice_open_b, linear_clamp, uvw, 0.0);
        return select(z.y, z.x, forward);
    }
    let xy = textureSampleLevel(lattice_open_a, linear_clamp, uvw, 0.0);
    let along = select(xy.xy, xy.zw, axis == 1u);
    return select(along.y, along.x, forward);
}

// How much of a closed face that a ray crosses `height` cells above its own surface is that
// surface: a slanted one lies in the way of rays along it, in steps as large as cells.
fn glossy_own(n: vec3f, towards: vec3f, axis: u32, height: f32) -> f32 {
    let against = max(0.0, -n[axis] * towards[axis]);
    return GLOSSY_OWN * against * (1.0 - smoothstep(0.75, 1.75, height));
}

// No lower over the surface than where that looks its own light up.
fn glossy_raised(place: vec3f, lookup: vec3f, n: vec3f) -> vec3f {
    return place + n * max(0.0, dot(lookup - place, n));
}

// The ray r of a surface of normal n at `surface` that looks its own light up at `lookup` (both
// bent cells).
fn glossy_ray(
    lattice: LatticeParams, surface: vec3f, lookup: vec3f, n: vec3f, r: vec3f, alpha: f32,
) -> Glossy {
    let ray = GlossyRay(n, r, alpha, GLOSSY_START);
    return glossy_walk(lattice, surface, lookup, ray, glossy_begun(), true);
}

fn glossy_begun() -> Glossy {
    return Glossy(vec3f(0.0), 1.0, 1.0, vec3f(0.0), 0.0, true);
}

// The same, from where `before` (of a finer lattice, its end in cells of this one) ended.
fn glossy_walk(
    lattice: LatticeParams, surface: vec3f, lookup: vec3f, ray: GlossyRay, before: Glossy,
    is_outermost: bool,
) -> Glossy {
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
    var t = before.end;
    var left = before.left;
    var transmittance = mix(GLOSSY_LEAST_LEFT, 1.0, left);
    var irradiance = before.irradiance;
    for (var i = 0u; i < GLOSSY_CELLS && left > 0.0; i++) {
        var axis = select(0u, 1u, crossing.y < crossing.x);
        axis = select(axis, 2u, crossing.z < crossing[axis]);
        t = crossing[axis];
        var next = cell;
        next[axis] += towards[axis];
        if (t >= reach || next[axis] < 0.0 || next[axis] >= count[axis]) {
            break;
        }
        var place = start + t * r;
        let own = glossy_own(n, towards, axis, dot(place - surface, n));
        let open = min(1.0, glossy_open(lattice, next, place, axis, towards[axis] > 0.0) + own);
        transmittance *= open;
        let kept = saturate((transmittance - GLOSSY_LEAST_LEFT) / (1.0 - GLOSSY_LEAST_LEFT));
        if (kept < left) {
            place[axis] = cell[axis] + 0.5;
            let uvw = lattice_eased(lattice, glossy_raised(place, lookup, n));
            irradiance += (left - kept) * lattice_irradiance_at(lattice, uvw, r);
        }
        left = kept;
        cell = next;
        crossing[axis] += per_cell[axis];
    }
    t = min(t, reach);
    let border = select(-start, count - start, r > vec3f(0.0)) * towards * per_cell;
    let inside = saturate((min(border.x, min(border.y, border.z)) - t) / GLOSSY_BORDER);
    let uvw = lattice_eased(lattice, glossy_raised(start + t * r, lookup, n));
    let lit = left * select(1.0, inside, is_outermost);
    return Glossy(irradiance, left, lit, uvw, t, t < widest && left > 0.0);
}
