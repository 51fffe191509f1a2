// The lattices' light from near occluders. The including pass binds what lattice and near_field_lookup need.
//! use occlusion
//! use near_field_texel

// Irradiance, W m^-2, that the lattice has coming from the near occluders that show their light.
fn from_occluders(lattice: LatticeParams, uvw: vec3f, near: NearField) -> vec3f {
    let seen = 1.0 - near.hidden;
    let light = vec3f(
        hidden_flux(textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0), near.direction, seen),
        hidden_flux(textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0), near.direction, seen),
        hidden_flux(textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0), near.direction, seen));
    let area = lattice.cell * lattice.cell * lattice.power_scale;
    return light * (3.14159265 * lattice.lookup_scale / area);
}
