// Light that media have scattered forwards alone, which no ray meets, added to what points have gathered.
//! use point_sums
//! use stored_sums
//! use tone
//! use surface_coordinates

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let place = textureLoad(places, id.xy, 0);
    var found = sums_at(sums, id.xy);
    if (place.w <= 0.0) {
        store_sums(id.xy, found);
        return;
    }
    let normal = textureLoad(normals, id.xy, 0).xyz;
    // All lattices have the same axes.
    let n = lattice_from_world(lattices[0], normal);
    // Nested lattices fade into each other, the finest first.
    let last = arrayLength(&lattices) - 1u;
    var e = vec3f(0.0);
    var left = 1.0;
    var k = 0u;
    loop {
        let weight = left * select(lattice_weight(lattices[k], place.xyz), 1.0, k == last);
        if (weight > 0.0) {
            let uvw = lattice_coordinates(lattices[k], place.xyz, n);
            e += weight * lattice_irradiance(lattices[k], uvw, n);
        }
        left -= weight;
        k++;
        if (k > last || left <= 0.0) { break; }
    }
    // As the sum of the radiance that as many rays would have found.
    let sum = e * f32(params.rays) / 3.14159265;
    found.near += sum;
    found.near_flux += luminance(sum) * normal;
    store_sums(id.xy, found);
}
