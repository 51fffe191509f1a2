// The sky's light that surfaces send to the eye. The including pass binds what mirrored_light needs.
//! use surface_reflection
//! use occlusion

struct SkyReflected {
    shown: vec3f,       // radiance, W m^-2 sr^-1: of what near field leave open
    returned: vec3f,    // what comes back from those
}

// `sky`, `mirrored`: irradiance on the surface, and around the mirrored direction; `open`: the share that
// near field leave, `mirrors`: how much of a surface's light is what it mirrors.
fn sky_reflected(
    r: Reflector, n_v: f32, sky: vec3f, mirrored: vec3f, open: f32, mirrors: vec3f,
) -> SkyReflected {
    let diffuse = (vec3f(1.0) - specular_albedo(r, n_v)) * r.diffuse;
    let returned = diffuse * (interreflected(open, r.diffuse) - open) * sky;
    return SkyReflected((diffuse * sky * open + mirrors * mirrored) / PI, returned / PI);
}
