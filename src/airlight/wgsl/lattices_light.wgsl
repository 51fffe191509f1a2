// What all lattices give to a surface, the finest that has it first. The including pass binds what
// sky_reflected needs, and declares `is_traced_separately`.
//! use sky_reflected
//! use near_field_lookup
//! use near_field
//! use mirrored_light
//! use surface_coordinates
//! needs fn is_traced_separately(r: Reflector, n_v: f32) -> bool

override DAMPING: f32 = 0.0;
override HAS_NEAR_FIELD: bool = false;  // near surfaces' own light replaces what they hide
override RETURNED: f32 = 0.0;           // 1: the lattice's light bounces between near surfaces

// Cells towards the eye, which sees no wall from behind: where walls meet, rounding has some points behind one of them,
// and how far walls lie from faces is known to .004 of a cell.
const TOWARDS_EYE = 0.02;

struct LatticeLight {
    sky: SkyReflected,
    indirect: vec3f,     // radiance, W m^-2 sr^-1
}

// What one lattice gives to a surface at the world point p; n, v and what is near are along its axes.
fn lattice_light(
    level: u32, uvw: vec3f, p: vec3f, r: Reflector, n: vec3f, v: vec3f, n_v: f32, near: NearField,
    mirrors: vec3f,
) -> LatticeLight {
    let lattice = lattice_of(level);
    let mirrored = reflect(-v, n);
    // Irradiance from around the normal, and what comes from around the mirrored direction.
    var e = lattice_irradiance(lattice, uvw, n);
    if (DAMPING > 0.0) {
        e *= lattice_damping(lattice, uvw, n, DAMPING);
    }
    let mirror = mirrored_light(level, p, r, n_v, n, uvw, mirrored);
    let diffuse = (vec3f(1.0) - specular_albedo(r, n_v)) * r.diffuse;
    // The sky, and the lattice's light, as far as near surfaces leave them.
    let seen = interreflected(near.open, r.diffuse);
    var sky = sky_reflected(r, n_v, sky_at(uvw, n), mirror.sky, near.open, mirrors);
    if (!HAS_NEAR_FIELD) {
        sky = SkyReflected(sky.shown + sky.returned, vec3f(0.0));
        e *= seen;
    } else {
        // What the near field hide comes back as their own light.
        let open = 1.0 - near.hidden;
        let returned = RETURNED * (interreflected(open, r.diffuse) - open) * e;
        e = replaced(e, from_occluders(lattice, uvw, near), near.light) + returned;
    }
    return LatticeLight(sky, (diffuse * e + mirrors * mirror.indirect) / PI);
}

// What reaches the eye at `position` in the image, at depth d, from p; v leads to the eye.
fn gathered(position: vec2f, d: f32, p: vec3f, r: Reflector, n: vec3f, v: vec3f) -> Gathered {
    var near = near_field_at(position, 1.0 / (params.world_from_clip[2].w * d));
    // All lattices have the same axes.
    let axes = lattice_of(0u);
    let n_own = lattice_from_world(axes, n);
    let v_own = lattice_from_world(axes, v);
    near.direction = lattice_from_world(axes, near.direction);
    let n_v = max(dot(n, v), 1e-4);
    let is_listed = is_traced_separately(r, n_v);
    // As far as the near field lets it in.
    let reached = specular_visibility(near.open, n_v, sqrt(r.alpha));
    let mirrors = select(reached * specular_albedo(r, n_v), vec3f(0.0), is_listed);
    var out = Gathered(vec3f(0.0), vec3f(0.0), reached, is_listed);
    // From the finest lattice outwards, each by its weight at the point.
    var at = lattice_step(0u, 1.0, p);
    loop {
        let uvw = lattice_coordinates(lattice_of(at.k), p + TOWARDS_EYE * lattice_of(at.k).cell * v, n_own);
        let light = lattice_light(at.k, uvw, p, r, n_own, v_own, n_v, near, mirrors);
        out.direct += at.weight * light.sky.shown;
        out.indirect += at.weight * light.indirect;
        out.indirect += at.weight * light.sky.returned;
        if (at.is_last) {
            break;
        }
        at = lattice_step(at.k + 1u, at.left, p);
    }
    return out;
}
