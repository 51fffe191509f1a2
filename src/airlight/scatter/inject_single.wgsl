// Light that media scatter once, as the isotropic power of each cell (Billeter2012 section 4.1).
//! use lattice_space
//! use media_light
//! use cell_light
//! use lights_in_media
//! use forward_depths
//! use octants
//! use cell_order
//! use tone
//! needs fn shining_light(i: u32) -> LightData
//! needs fn computed_cell(id: vec3u) -> vec3u
//! needs fn keep_light(cell: u32, light: Arriving)

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
    // Each ball has the mean of 1/r^2 over it, and is attenuated by as much less as it is nearer.
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

// Light of all lights, averaged over a box or a cell, W m^-2.
struct Arriving {
    reduced: vec3f,     // as reduced media attenuate it
    straight: vec3f,    // as the media themselves do
    along: vec3f,       // of that its luminance, times the mean direction in which it travels
}

// The mean direction, of at most unit length, of a light's travel through a box of sides `size` that it may be in: of
// both the mean squares of distance count.
fn mean_travel(light: LightData, p: vec3f, size: vec3f) -> vec3f {
    if (light.kind == LIGHT_DIRECTIONAL) {
        return light.direction;
    }
    let offset = light.position - p;
    return -offset / max(sqrt(dot(offset, offset) + dot(size, size) / 12.0), 1e-9);
}

// Of the light that reaches a box about p the part that the media themselves let straight through.
fn with_straight(sum: Arriving, light: LightData, p: vec3f, size: vec3f, reduced: vec3f, forward: vec3f) -> Arriving {
    let straight = reduced * exp(-forward);
    let along = luminance(straight) * mean_travel(light, p, size);
    return Arriving(sum.reduced + reduced, sum.straight + straight, sum.along + along);
}

// What arrives in a box of sides `size` about p.
fn arriving(p: vec3f, size: vec3f, sigma_t: vec3f) -> Arriving {
    let radius = ball_radius(size);
    var sum = Arriving(vec3f(0.0), vec3f(0.0), vec3f(0.0));
    for (var i = 0u; i < params.light_count; i++) {
        let light = shining_light(i);
        // What arrives at the middle of the box, unless surfaces or the light's cone keep it off.
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
        var depth = vec3f(0.0);
        var forward = vec3f(0.0);
        if (KEEPS_LIGHT) {
            let depths = depths_towards(light, i, p, false);
            depth = depths.reduced;
            forward = depths.forward;
        } else {
            depth = media_light_depth(light, i, p);
        }
        var here = vec3f(0.0);
        if (is_near) {
            here = lit * near_irradiance(light, p, size, sigma_t, exp(-depth));
        } else {
            let direction = lattice_from_world(lattice, in.to_light);
            let nearer = in.distance / reach;
            here = lit * in.irradiance * (nearer * nearer)
                * box_transmittance(depth, sigma_t, direction, size);
        }
        sum = with_straight(sum, light, p, size, here, forward);
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
    var straight = vec3f(0.0);
    var along = vec3f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let p = unwarped_point(lattice, id, octant_middle(k));
        let held = media_coefficients(p);
        if (any(held.scattering > vec3f(0.0))) {
            let light = arriving(p, size, held.extinction);
            power += held.scattering * light.reduced;
            straight += held.scattering * light.straight;
            along += luminance(held.scattering) * light.along;
            scattering += held.scattering;
        }
    }
    // Their means over what scatters.
    let least = vec3f(1e-20);
    let mean = Arriving(power / max(scattering, least), straight / max(scattering, least),
        along / max(luminance(scattering), 1e-20));
    // Scattered isotropically: a constant term alone.
    power *= size.x * size.y * size.z;
    let cells_in_all = lattice.count.x * lattice.count.y * lattice.count.z;
    let cell = cell_in(lattice.count, id);
    keep_light(cell, mean);
    for (var channel = 0u; channel < 3u; channel++) {
        let index = channel * cells_in_all + cell;
        cells[index] = base[index] + vec4f(power[channel], 0.0, 0.0, 0.0);
    }
}
