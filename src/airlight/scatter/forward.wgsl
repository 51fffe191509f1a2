// Of each cell, the light that was scattered forwards only: what the reduced medium transmits beyond
// the true medium. `store_light`, of all light that is unscattered in the reduced medium, is generated.
//! use lattice_space
//! use cell_light
//! use lights_in_media
//! use forward_beams
//! use forward_depths
//! use free_path
//! use octants
//! use cell_order
//! needs fn shining_light(i: u32) -> LightData
//! needs fn computed_cell(id: vec3u) -> vec3u
//! needs fn store_light(id: vec3u, i: u32, light: vec4f)
//! needs fn is_read(cell: u32) -> bool

const BLUR_CELLS = 6.0;         // that light spreads across its direction at most

// The light that reaches p through the reduced medium beyond the true one: it was deflected once.
fn gained_at(light: LightData, p: vec3f, lit: f32, depths: Depths) -> vec3f {
    // A local light may be in the cell, so its mean over the part is taken.
    let in = incoming_in_media(light, p);
    var irradiance = in.irradiance;
    if (light.kind != LIGHT_DIRECTIONAL) {
        let near = ball_radius(vec3f(0.5 * lattice.cell));
        irradiance *= gain_in_ball(light, in.distance, near);
    }
    if (all(irradiance * depths.forward == vec3f(0.0))) {
        return vec3f(0.0);
    }
    return lit * irradiance * passed_forwards(depths.reduced, depths.forward);
}

// Across a light's direction, in deviations: of one tap at each part two rings of four, each for half of a Gaussian; else
// equal shares of one, turned by the golden angle.
fn slant_aside(k: u32, tap: u32) -> vec2f {
    if (params.taps == 1u) {
        let turn = (f32(k) + 0.5) * 0.7853981634;
        return select(0.83, 1.82, (k & 1u) == 1u) * vec2f(cos(turn), sin(turn));
    }
    let number = f32(tap * 8u + (5u * k & 7u));
    let turn = number * 2.39996323;
    let share = (number + 0.5) / f32(8u * params.taps);
    return sqrt(-2.0 * log(1.0 - share)) * vec2f(cos(turn), sin(turn));
}

// How far back light of a tap was deflected, over the root mean square of that: anywhere on its path alike.
fn back_share(k: u32, tap: u32) -> f32 {
    let number = f32(tap * 8u + ((3u * k + 1u) & 7u)) + 0.5;
    return 1.7320508 * select(fract(number * 0.7548776662), number / 8.0, params.taps == 1u);
}

// Deflected light comes slantwise from a beam beside p, whose light is looked up where it was deflected. At lattice
// coordinates `start`; `depths` on the straight path.
fn slanted(light: LightData, i: u32, start: vec3f, k: u32, tap: u32, depths: Depths) -> vec3f {
    let across = normalize(cross(light.direction,
        select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(light.direction.y) < 0.7)));
    let radius = depths.deviation / lattice.cell;
    let far = back_share(k, tap);
    let ring = far * min(radius, BLUR_CELLS) * slant_aside(k, tap);
    let aside = lattice_from_world(lattice, ring.x * across + ring.y * cross(light.direction, across));
    let back = far * depths.back / lattice.cell * min(1.0, BLUR_CELLS / radius);
    let offset = aside - back * lattice_from_world(lattice, light.direction);
    // What was deflected behind a wall does not come here.
    let passed = passed_walls(start, offset);
    if (passed <= 0.0) {
        return vec3f(0.0);
    }
    // As much medium as there is before the point beside this one; lit if the beam is where it was deflected.
    let beside = depths_towards(light, i, world_point(start + aside), false);
    let p = world_point(start + offset);
    return passed * gained_at(light, p, lit_point(light, -light.direction, p), beside);
}

struct Part {
    straight: vec3f,    // W m^-2, attenuated by the true medium
    gained: vec3f,      // what the reduced medium does besides
    depth: f32,         // optical, of scattering
}

// Light that comes straight to p, where nobody asks for the rest: most of space has no media before it.
fn forward_alone(light: LightData, i: u32, p: vec3f) -> Part {
    let depths = depths_towards(light, i, p, !IS_SKY);
    if (all(depths.forward == vec3f(0.0))) {
        return Part(vec3f(0.0), vec3f(0.0), 0.0);
    }
    let lit = lit_point(light, incoming_in_media(light, p).to_light, p);
    if (lit <= 0.0) {
        return Part(vec3f(0.0), vec3f(0.0), 0.0);
    }
    return Part(vec3f(0.0), gained_at(light, p, lit, depths), 0.0);
}

// Light that comes slantwise into all of a cell, by how much it spreads on its path to the middle.
fn slanted_alone(light: LightData, i: u32, id: vec3u, span: CellSpan) -> vec3f {
    let depths = depths_towards(light, i, point_in_span(lattice, span, vec3f(0.5)), true);
    if (depths.deviation <= 0.0) {
        return vec3f(0.0);
    }
    var sum = vec3f(0.0);
    for (var n = 0u; n < 8u * params.taps; n++) {
        let start = vec3f(id) + octant_middle(n & 7u);
        sum += slanted(light, i, start, n & 7u, n >> 3u, depths);
    }
    return sum / f32(8u * params.taps);
}

// Of light i at part k of a cell.
fn forward_part(light: LightData, i: u32, id: vec3u, span: CellSpan, k: u32) -> Part {
    let half = octant_middle(k);
    // What shines straight onto the part, as the true medium attenuates it.
    let p = point_in_span(lattice, span, half);
    if (FOR_SURFACES || IS_SKY) {
        return forward_alone(light, i, p);
    }
    // For marching also what media pass straight, and how deep in them the part lies.
    let own = incoming_in_media(light, p);
    let lit = lit_point(light, own.to_light, p);
    let depths = depths_towards(light, i, p, true);
    let depth = dot(depths.scattering, vec3f(1.0)) / 3.0;
    let straight = own.irradiance * exp(-depths.reduced - depths.forward);
    let seen = Part(straight * lit, vec3f(0.0), depth);
    // The rest was deflected once: out of beams beside this one where it has spread, else out of this one.
    let is_slanted = light.kind == LIGHT_DIRECTIONAL && depths.deviation > 0.0;
    if (!is_slanted) {
        return Part(seen.straight, gained_at(light, p, lit, depths), depth);
    }
    var gained = vec3f(0.0);
    for (var tap = 0u; tap < params.taps; tap++) {
        gained += slanted(light, i, vec3f(id) + half, k, tap, depths);
    }
    return Part(seen.straight, gained / f32(params.taps), depth);
}

// The direction in which light travels at the cell's centre.
fn travel_of(light: LightData, span: CellSpan) -> vec3f {
    if (light.kind == LIGHT_DIRECTIONAL) {
        return light.direction;
    }
    let away = point_in_span(lattice, span, vec3f(0.5)) - light.position;
    return away / max(length(away), 1e-6);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let id = computed_cell(invocation);
    if (any(id == NO_CELL)) {
        return;
    }
    let cells = lattice.count.x * lattice.count.y * lattice.count.z;
    let cell = cell_in(lattice.count, id);
    let span = cell_span(lattice, id);
    var fluence = vec3f(0.0);
    var flux = mat3x3f();   // columns x, y, z of rgb
    // Each light at eight points of the cell, or at a few where there are many lights.
    let light_count = select(0u, params.light_count, is_read(cell));
    // Of every so many lights one, of each cell another than of its neighbours.
    let first_light = (id.x + id.y + id.z) % params.light_step;
    for (var i = first_light; i < light_count; i += params.light_step) {
        let light = shining_light(i);
        var sum = vec3f(0.0);
        var passed = vec4f(0.0);
        let is_whole = FOR_SURFACES && !IS_SKY && light.kind == LIGHT_DIRECTIONAL;
        if (is_whole) {
            sum = 8.0 / f32(params.stride) * slanted_alone(light, i, id, span);
        }
        for (var k = select(0u, 8u, is_whole); k < 8u; k += params.stride) {
            // Of few parts the next light takes others.
            let turned = (k + select(0u, 3u * i, params.stride > 1u)) & 7u;
            let part = forward_part(light, i, id, span, turned);
            sum += part.gained;
            passed += vec4f(part.straight + part.gained, part.depth);
        }
        sum *= f32(params.stride * params.light_step) / 8.0;
        store_light(id, i, f32(params.stride) / 8.0 * passed);
        let along = lattice_from_world(lattice, travel_of(light, span));
        fluence += sum;
        flux += mat3x3f(sum * along.x, sum * along.y, sum * along.z);
    }
    // Power units: fluence and flux times the cell's volume, W m.
    let volume = lattice.cell * lattice.cell * lattice.cell;
    for (var c = 0u; c < 3u; c++) {
        let index = c * cells + cell;
        forward[index] = base[index]
            + volume * vec4f(fluence[c], flux[0][c], flux[1][c], flux[2][c]);
    }
}
