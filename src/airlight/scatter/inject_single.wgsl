// Light that media scatter once, as the isotropic power of each cell (Billeter2012 section 4.1).
//! use lattice_space
//! use media_light
//! use cell_light
//! use lights_in_media
//! use octants
//! use cell_order
//! needs fn computed_cell(id: vec3u) -> vec3u
//! needs fn keep_light(cell: u32, fluence: vec3f)

// How far p is from a light, `cut` where that is the least that counts. A medium's own light is all
// within it: of its samples nothing is cut off.
fn true_reach(light: LightData, p: vec3f, cut: f32) -> f32 {
    let is_own = light.kind == LIGHT_SAMPLE && light.shape_x == 0.0;
    return select(cut, max(length(light.position - p), 1e-9), is_own);
}

// Mean irradiance of a local light over a box of sides `size` about p, which it is close to, and which it
// reaches attenuated by `passed` at p. The box is cut into 27, each of which stands for a ball.
fn near_irradiance(light: LightData, p: vec3f, size: vec3f, sigma_t: vec3f, passed: vec3f) -> vec3f {
    let distance = media_light_path(light, p).w;
    let radius = ball_radius(size) / 3.0;
    var sum = vec3f(0.0);
    for (var k = 0u; k < 27u; k++) {
        let third = vec3f(cell_at_index(vec3u(3u), k)) - 1.0;
        let at = p + world_from_lattice(lattice, third * size / 3.0);
        let in = incoming_in_media(light, at);
        let reach = true_reach(light, at, in.distance);
        let spread = in.distance * in.distance * mean_inverse_square(reach, radius);
        sum += in.irradiance * select(spread, 1.0, has_size(light)) * min(passed * exp(sigma_t * (distance - reach)),
            vec3f(1.0));
    }
    return sum / 27.0;
}

// The light's mean over a box of sides `size` about p, where it is attenuated by depth x = sigma |d|
// size per axis, d its direction along the box's axes: exp(-depth) times the product of
// sinh(x/2)/(x/2).
fn box_transmittance(depth: vec3f, sigma_t: vec3f, direction: vec3f, size: vec3f) -> vec3f {
    let across = abs(direction) * size;
    var result = vec3f(1.0);
    for (var axis = 0u; axis < 3u; axis++) {
        result *= mean_transmittance_rgb(sigma_t * across[axis]);
    }
    let half = 0.5 * sigma_t * (across.x + across.y + across.z);
    return min(result * exp(half - depth), vec3f(1.0));
}

// Irradiance of all lights, W m^-2, averaged over a box of sides `size` about p.
fn arriving(p: vec3f, size: vec3f, sigma_t: vec3f) -> vec3f {
    let radius = ball_radius(size);
    var sum = vec3f(0.0);
    for (var i = 0u; i < params.light_count; i++) {
        let light = lights[i];
        let in = incoming_in_media(light, p);
        let reach = true_reach(light, p, in.distance);
        let is_near = reach < 4.0 * radius;
        if (!is_near && all(in.irradiance <= vec3f(0.0))) {
            continue;
        }
        let lit = lit_point(light, in.to_light, p);
        if (lit <= 0.0) {
            continue;
        }
        // Within the box irradiance varies with distance where the light is near, else by attenuation.
        let depth = media_light_depth(light, i, p);
        if (is_near) {
            sum += lit * near_irradiance(light, p, size, sigma_t, exp(-depth));
        } else {
            let direction = lattice_from_world(lattice, in.to_light);
            let nearer = in.distance / reach;
            sum += lit * in.irradiance * (nearer * nearer)
                * box_transmittance(depth, sigma_t, direction, size);
        }
    }
    return sum;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let id = computed_cell(invocation);
    if (any(id == NO_CELL)) {
        return;
    }
    // An eighth of the cell at a time, as the warp has it.
    let low = lattice.cell * unwarped_coordinates(lattice, id, vec3f(0.0));
    let high = lattice.cell * unwarped_coordinates(lattice, id, vec3f(1.0));
    let size = 0.5 * (high - low);
    var power = vec3f(0.0);
    var scattering = vec3f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let p = unwarped_point(lattice, id, octant_middle(k));
        let held = media_coefficients(p);
        if (any(held.scattering > vec3f(0.0))) {
            power += held.scattering * arriving(p, size, held.extinction);
            scattering += held.scattering;
        }
    }
    let fluence = power / max(scattering, vec3f(1e-20));
    // Scattered isotropically: a constant term alone.
    power *= size.x * size.y * size.z;
    let cells_in_all = lattice.count.x * lattice.count.y * lattice.count.z;
    let cell = cell_in(lattice.count, id);
    keep_light(cell, fluence);
    for (var channel = 0u; channel < 3u; channel++) {
        let index = channel * cells_in_all + cell;
        cells[index] = base[index] + vec4f(power[channel], 0.0, 0.0, 0.0);
    }
}
