// The radiance along the rays of each cell: its mean, and what of it media there scatter towards the eye.
// Cells that sent no rays keep what they had: what the lattice solved, if they never did.
//! use guide_air
//! use cell_order
//! use tone
//! use half_range

const NO_POINT = 0xffffffffu;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let cell = params.first + cell_in(lattice.count, id);
    let texel = id + vec3u(0u, lattice.first_row, 0u);
    // The first gather point of the cell, as cell_points.wgsl laid it, and how many follow one another.
    let points = points_of_cells[cell];
    let first = points.x;
    if (first == NO_POINT) {
        if (params.number == 0u) {
            let scattered = textureLoad(solved, texel, 0).rgb - textureLoad(straight, texel, 0).rgb;
            let mean = params.solved_scale * max(scattered, vec3f(0.0));
            before[2u * cell] = vec4f(mean, 0.0);
            before[2u * cell + 1u] = vec4f(0.0);
            textureStore(inscattered, texel, vec4f(in_half_range(params.scale * mean), 1.0));
        }
        return;
    }
    let at = vec2u(first % params.width, first / params.width);
    let axis = textureLoad(axes, at, 0);
    let g = textureLoad(cosines, at, 0).rgb;
    var mean_radiance = vec3f(0.0);
    var along = vec3f(0.0);
    var towards_eye = vec3f(0.0);
    let count = points.y * params.rays;
    var k = 0u;
    loop {
        if (k >= count) { break; }
        // Each ray counts by how likely its direction was (balance heuristic, Veach1995).
        let point = first + k / params.rays;
        let ray = k % params.rays;
        let radiance = paths[2u * (point + ray * params.points)].rgb;
        let source = vec2u(point % params.width, point / params.width);
        let numbers = ray_numbers(source.x, source.y, params.first_ray + ray);
        let sent = air_ray(textureLoad(places, source, 0).xyz, axis, numbers);
        let found = radiance / sent.density;
        mean_radiance += PHASE_ISOTROPIC * found;
        along -= PHASE_ISOTROPIC * luminance(found) * sent.direction;
        towards_eye += scattering_phase(-dot(sent.direction, axis.xyz), g) * found;
        k++;
    }
    // What rays of the next sample meet in the air: the mean of all samples in which it sent rays, the later ones more.
    let row = 2u * cell;
    let earlier = select(before[row], vec4f(0.0), params.number == 0u);
    let weight = 2.0 / (earlier.a + 2.0);
    before[row] = vec4f(mix(earlier.rgb, mean_radiance / f32(count), weight), earlier.a + 1.0);
    before[row + 1u] = mix(before[row + 1u], vec4f(along / f32(count), 0.0), weight);
    // The sum as marching reads it, scaled to half floats.
    let seen = params.scale / f32(count) * towards_eye;
    textureStore(inscattered, texel, vec4f(in_half_range(seen), 1.0));
}
