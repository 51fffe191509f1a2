// What a solved lattice scatters towards the eye. The including pass declares MarchParams `march`
// and binds what `lattice` needs.
//! use air
//! use lattice

fn lattice_radiance(state: vec4f, travel: vec3f, g: f32) -> f32 {
    return max(0.0, state.x + march.lattice_direct * g * dot(state.yzw, travel));
}

// W m^-3 sr^-1: the phase function keeps the mean radiance, and g of its two-band direction.
fn lattice_emission(p: vec3f, travel: vec3f) -> vec3f {
    let weight = march.lattice_scale * lattice_weight(lattice, p);
    if (weight <= 0.0) {
        return vec3f(0.0);
    }
    let uvw = lattice_coordinates(lattice, p, vec3f(0.0));
    let red = textureSampleLevel(lattice_red, linear_clamp, uvw, 0.0);
    let green = textureSampleLevel(lattice_green, linear_clamp, uvw, 0.0);
    let blue = textureSampleLevel(lattice_blue, linear_clamp, uvw, 0.0);
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        let g = air[m].g;
        sum += air_density(m, p) * air[m].sigma_t * air[m].albedo
            * vec3f(lattice_radiance(red, travel, g.r), lattice_radiance(green, travel, g.g),
                lattice_radiance(blue, travel, g.b));
    }
    return weight * sum;
}
