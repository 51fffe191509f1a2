// The radiance along the rays of each cell in two bands, as marching reads lattices (scatter/emission.py).
//! use gather
//! use lattice_axes

const LARGEST_HALF = 65504.0;

fn stored(a: f32, b: vec3f) -> vec4f {
    return clamp(params.scale * vec4f(a, b), vec4f(-LARGEST_HALF), vec4f(LARGEST_HALF));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    // The gather point of the cell, as cell_points.wgsl laid it.
    let point = params.first + (id.z * lattice.count.y + id.y) * lattice.count.x + id.x;
    let at = vec2u(point % params.width, point / params.width);
    var mean_radiance = vec3f(0.0);
    var flux: array<vec3f, 3>;
    var k = 0u;
    loop {
        if (k >= params.rays) { break; }
        let radiance = paths[2u * (point + k * params.points)].rgb;
        let direction = sphere_direction(ray_numbers(at.x, at.y, params.first_ray + k));
        // Light travels against the ray that found it.
        let along = -3.0 * lattice_from_world(lattice, direction);
        mean_radiance += radiance;
        flux[0] += radiance.r * along;
        flux[1] += radiance.g * along;
        flux[2] += radiance.b * along;
        k++;
    }
    let texel = id + vec3u(0u, lattice.first_row, 0u);
    // What rays of the next sample meet in the air: the mean of this and earlier samples, the later ones more.
    let found = mean_radiance / f32(params.rays);
    let kept = mix(before[point].rgb, found, params.weight);
    before[point] = vec4f(kept, 0.0);
    // The sums as marching reads them, scaled to half floats.
    textureStore(red, texel, stored(mean_radiance.r, flux[0]));
    textureStore(green, texel, stored(mean_radiance.g, flux[1]));
    textureStore(blue, texel, stored(mean_radiance.b, flux[2]));
    let mean_stored = min(params.scale * mean_radiance, vec3f(LARGEST_HALF));
    textureStore(mean, texel, vec4f(mean_stored, 1.0));
}
