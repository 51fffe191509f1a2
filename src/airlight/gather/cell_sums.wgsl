// The radiance along the rays of each cell: its mean, and what of it media there scatter towards the eye.
//! use gather
//! use cell_order

const LARGEST_HALF = 65504.0;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    // The gather point of the cell, as cell_points.wgsl laid it.
    let point = params.first + cell_in(lattice.count, id);
    let at = vec2u(point % params.width, point / params.width);
    let axis = textureLoad(axes, at, 0);
    let g = textureLoad(cosines, at, 0).rgb;
    var mean_radiance = vec3f(0.0);
    var towards_eye = vec3f(0.0);
    var k = 0u;
    loop {
        if (k >= params.rays) { break; }
        // Each ray counts by how likely its direction was (balance heuristic, Veach1995).
        let radiance = paths[2u * (point + k * params.points)].rgb;
        let direction = lobe_direction(-axis.xyz, axis.w, ray_numbers(at.x, at.y, params.first_ray + k));
        let cosine = -dot(direction, axis.xyz);
        let found = radiance / lobe_density(cosine, axis.w);
        mean_radiance += PHASE_ISOTROPIC * found;
        towards_eye += scattering_phase(cosine, g) * found;
        k++;
    }
    let texel = id + vec3u(0u, lattice.first_row, 0u);
    // What rays of the next sample meet in the air: the mean of this and earlier samples, the later ones more.
    let kept = mix(before[point].rgb, mean_radiance / f32(params.rays), params.weight);
    before[point] = vec4f(kept, 0.0);
    // The sum as marching reads it, scaled to half floats.
    textureStore(inscattered, texel, vec4f(min(params.scale * towards_eye, vec3f(LARGEST_HALF)), 1.0));
}
