// What the lattices mirror to the eye, and what a loop over lattices needs. The including pass binds
// what lattice and ambient_cube need, the table `lattices` and `first_lattices`, depth, near_field and
// `params`.
//! use surface_reflection
//! use glossy
//! use lattice
//! use ambient_cube

override HAS_OCCLUSION: bool = false;
override HAS_GLOSS: bool = false;
override IS_LISTED: bool = false;       // all points are glossy
override HAS_SKY: bool = true;
override IS_ONE_LATTICE: bool = false;

// Of a single lattice what a loop needs is read once, and nothing is left of loops over lattices.
fn lattice_of(k: u32) -> LatticeParams {
    if (IS_ONE_LATTICE) {
        return first_lattices();
    }
    return lattices[k];
}

fn last_lattice() -> u32 {
    if (IS_ONE_LATTICE) {
        return 0u;
    }
    return arrayLength(&lattices) - 1u;
}

// The first of the lattices from k on that has the point; the last one if none has it.
fn lattice_from(k: u32, p: vec3f) -> u32 {
    let last = last_lattice();
    var i = k;
    loop {
        if (i >= last || lattice_weight(lattice_of(i), p) > 0.0) {
            break;
        }
        i++;
    }
    return i;
}

// One step of a walk over the lattices that have a point: the finest, and towards its border the next larger one, until
// no weight is left.
struct LatticeStep {
    k: u32,
    weight: f32,
    left: f32,          // for larger lattices
    is_last: bool,
}

// The step from lattice k on, with `left` of the weight.
fn lattice_step(k: u32, left: f32, p: vec3f) -> LatticeStep {
    let found = lattice_from(k, p);
    let weight = left * lattice_weight(lattice_of(found), p);
    let rest = left - weight;
    return LatticeStep(found, weight, rest, found >= last_lattice() || rest <= 0.0);
}

fn sky_at(uvw: vec3f, n: vec3f) -> vec3f {
    if (!HAS_SKY) {
        return vec3f(0.0);
    }
    return sky_irradiance(uvw, n);
}

struct Mirrored {
    sky: vec3f,         // irradiance, W m^-2
    indirect: vec3f,
}

// What comes from around the mirrored direction, which is along the lattices' axes as the normal is: of the point's own cell (looked up at `own`, which
// points that are all glossy need not know), or along a ray, which goes on in the next larger lattice
// where it leaves one.
fn mirrored_light(
    level: u32, p: vec3f, r: Reflector, n_v: f32, n: vec3f, own: vec3f, mirrored: vec3f,
) -> Mirrored {
    var k = level;
    var uvw = own;
    if (!HAS_GLOSS) {
        return Mirrored(sky_at(own, mirrored),
            lattice_irradiance_at(lattice_of(k), own, mirrored));
    }
    // A mirrored ray through the lattices, each followed until the next larger takes over.
    var ray = Glossy(vec3f(0.0), 1.0, 1.0, own, 0.0, false);
    let share = glossy_share(specular_albedo(r, n_v), sqrt(r.alpha));
    if (IS_LISTED || share > 0.0) {
        ray = glossy_begun();
        let last = last_lattice();
        loop {
            let coordinates = warped_coordinates(lattice_of(k), p);
            let lookup = lookup_coordinates(lattice_of(k), coordinates, n);
            uvw = lattice_eased(lattice_of(k), lookup, vec3f(0.0));
            let raised = GLOSSY_START * lattice_of(level).cell / lattice_of(k).cell;
            let begin = GlossyRay(n, mirrored, r.alpha, raised);
            ray = glossy_walk(lattice_of(k), coordinates, lookup, begin, ray, k == last);
            if (k == last || !ray.is_cut) {
                break;
            }
            ray.end *= lattice_of(k).cell / lattice_of(k + 1u).cell;
            k++;
        }
    }
    // Rough surfaces read their own cell instead: both are blended by the surface's gloss.
    let end = mix(uvw, ray.uvw, share);
    return Mirrored(mix(1.0, ray.left, share) * sky_at(end, mirrored),
        share * ray.irradiance
            + mix(1.0, ray.lit, share) * lattice_irradiance_at(lattice_of(k), end, mirrored));
}
