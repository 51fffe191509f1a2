// A third band of what a lattice holds: of light of fluence e that goes towards w, the traceless
// tensor e (w w^T - 1/3). Its slabs along z: (xx, yy, xy, xz) of red, green and blue, then their yz.
// The phase function of Henyey and Greenstein keeps 5 g^2 P2 of it. The including pass binds
// `sky_third` and what march_lattice.wgsl needs.
//! use march_lattice

fn third_slab(k: f32) -> vec4f {
    let layers = f32(textureDimensions(sky_third).z) / 4.0;
    var sum = vec4f(0.0);
    var i = 0u;
    loop {
        let at = lattice_at[i];
        let z = clamp(at.z, 0.5 / layers, 1.0 - 0.5 / layers);
        sum += at.w
            * textureSampleLevel(sky_third, linear_clamp, vec3f(at.xy, 0.25 * (z + k)), 0.0);
        i++;
        if (i >= LATTICES_AT_ONCE || lattice_at[min(i, LATTICES_AT_ONCE - 1u)].w <= 0.0) { break; }
    }
    return sum;
}

// Per g^2, rgb; `travel`: unit, of the light that leaves, along the lattices' axes.
fn sky_third_at(travel: vec3f) -> vec3f {
    let v = travel;
    let squares = vec4f(
        v.x * v.x - v.z * v.z, v.y * v.y - v.z * v.z, 2.0 * v.x * v.y, 2.0 * v.x * v.z);
    let rest = 2.0 * v.y * v.z * third_slab(3.0).rgb;
    return 7.5 * (rest + vec3f(
        dot(third_slab(0.0), squares), dot(third_slab(1.0), squares), dot(third_slab(2.0), squares)));
}
