// Light that media have scattered forwards alone, which no ray meets, added to what points have gathered.
//! use tone
//! use lattice

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let place = textureLoad(places, id.xy, 0);
    if (place.w <= 0.0) {
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
    let at = id.y * params.reduced.x + id.x;
    sums[at].near += sum;
    sums[at].near_flux += luminance(sum) * normal;
}
