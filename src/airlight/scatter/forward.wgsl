// Of each cell, the light that was scattered forwards only: what the reduced medium transmits beyond
// the true medium. `store_light`, of all light that is unscattered in the reduced medium, is generated.
//! use lattice_space
//! use media_light
//! use cell_light
//! use lights_in_media
//! use entering_share
//! needs fn computed_cell(id: vec3u) -> vec3u
//! needs fn store_light(id: vec3u, i: u32, light: vec4f)

const BLUR_CELLS = 6.0;         // that light spreads across its direction at most

struct Depths {
    reduced: vec3f,     // optical depth of the reduced medium
    forward: vec3f,     // what the true medium has besides
    scattering: vec3f,  // of it
    deviation: f32,     // m, of the light's spread across its direction
    back: f32,          // m, from where it is deflected
}

// All media between p and a light.
fn depths_towards(light: LightData, index: u32, p: vec3f) -> Depths {
    let path = media_light_path(light, p);
    var sum = Depths(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0);
    var walk = walk_towards(index, p, path);
    for (var v = 0u; v < MEDIA_VISITS; v++) {
        let m = next_towards(&walk);
        if (walk.is_done) { break; }
        if (m == NO_MEDIUM) { continue; }
        let column = media_light_column(m, index, p, path);
        let reduced = media[m].sigma_t * column;
        let isotropic = max(vec3f(1e-4), 1.0 - media[m].g);
        sum.reduced += reduced;
        let scattering = reduced * media[m].albedo / isotropic;
        sum.forward += scattering * media[m].g;
        sum.scattering += scattering;
        // Of the green of spread; lengths of several media add up. Where all of a path deflects alike, the place
        // is 1/sqrt(3) of it back (root mean square).
        let deflecting = select(0.0, column, media[m].g.g > 0.0);
        sum.deviation += 0.29 * sqrt(2.0 * isotropic.g) * deflecting;
        sum.back += 0.58 * deflecting;
    }
    return sum;
}

// Whether walls close the face that a hop crosses into a cell.
fn is_shut(cell: vec3i, hop: u32) -> bool {
    let c = vec3u(clamp(cell, vec3i(0), vec3i(lattice.count) - 1));
    let index = (c.z * lattice.count.y + c.y) * lattice.count.x + c.x;
    return entering_share(face_visibility[index], hop) < 0.5;
}

// From lattice coordinates by an `offset` in cells, but not through walls.
fn moved_freely(start: vec3f, offset: vec3f) -> vec3f {
    let steps = ceil(length(offset));
    var at = start;
    for (var i = 0.0; i < steps; i += 1.0) {
        let next = at + offset / steps;
        let from_cell = vec3i(floor(at));
        // Beyond the lattice no walls are known.
        if (any(from_cell < vec3i(0)) || any(from_cell >= vec3i(lattice.count))) {
            return start + offset;
        }
        let to_cell = vec3i(floor(next));
        for (var axis = 0u; axis < 3u; axis++) {
            let step = to_cell[axis] - from_cell[axis];
            // Visibility is of the hops that enter a cell: + of a pair first.
            if (step != 0 && is_shut(to_cell, 2u * axis + select(1u, 0u, step > 0))) {
                return at;
            }
        }
        at = next;
    }
    return at;
}

// The world point of lattice coordinates. Beyond the lattice cells go on; within it walls stand where the warp has them.
fn place_of(coordinates: vec3f) -> vec3f {
    let cell = vec3u(clamp(vec3i(floor(coordinates)), vec3i(0), vec3i(lattice.count) - 1));
    return unwarped_point(lattice, cell, coordinates - vec3f(cell));
}

struct Part {
    straight: vec3f,    // W m^-2, attenuated by the true medium
    gained: vec3f,      // what the reduced medium does besides
    depth: f32,         // optical, of scattering
}

// Of light i at part k of a cell.
fn forward_part(light: LightData, i: u32, id: vec3u, span: CellSpan, k: u32) -> Part {
    let half = vec3f(vec3u(k & 1u, (k >> 1u) & 1u, k >> 2u)) * 0.5 + 0.25;
    // What shines straight onto the part, as the true medium attenuates it.
    var p = point_in_span(lattice, span, half);
    let own = incoming_in_media(light, p);
    var lit = lit_point(light, own.to_light, p);
    // In the shade nothing arrives, and the way through the media need not be known.
    if (params.is_blurred == 0u && lit <= 0.0) {
        return Part(vec3f(0.0), vec3f(0.0), 0.0);
    }
    var depths = depths_towards(light, i, p);
    let depth = dot(depths.scattering, vec3f(1.0)) / 3.0;
    let straight = own.irradiance * exp(-depths.reduced - depths.forward);
    let seen = Part(straight * lit, vec3f(0.0), depth);
    // What was deflected comes slantwise from a beam beside it, whose light is looked up where it was deflected.
    let radius = depths.deviation / lattice.cell;
    if (params.is_blurred != 0u && light.kind == LIGHT_DIRECTIONAL && radius > 0.0) {
        // Two rings of four, each for half of a Gaussian.
        let across = normalize(cross(light.direction,
            select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(light.direction.y) < 0.7)));
        let turn = (f32(k) + 0.5) * 0.7853981634;
        let ring = min(radius, BLUR_CELLS) * select(0.83, 1.82, (k & 1u) == 1u);
        let aside = lattice_from_world(lattice,
            ring * (cos(turn) * across + sin(turn) * cross(light.direction, across)));
        let back = depths.back / lattice.cell * min(1.0, BLUR_CELLS / radius);
        let offset = aside - back * lattice_from_world(lattice, light.direction);
        let start = vec3f(id) + half;
        let moved = moved_freely(start, offset);
        let way = length(moved - start) / length(offset);
        // As much medium as there is before the place beside this one; lit if the beam is where it was deflected.
        depths = depths_towards(light, i, place_of(start + way * aside));
        p = place_of(moved);
        lit = lit_point(light, own.to_light, p);
    }
    // A local light may be in the cell, so its mean over the part is taken.
    let in = incoming_in_media(light, p);
    var irradiance = in.irradiance;
    if (light.kind != LIGHT_DIRECTIONAL) {
        let near = ball_radius(vec3f(0.5 * lattice.cell));
        irradiance *= gain_in_ball(light, in.distance, near);
    }
    if (all(irradiance * depths.forward == vec3f(0.0))) {
        return seen;
    }
    // The reduced medium transmits more than the true one: that is what was deflected once.
    let gained = exp(-depths.reduced) * (1.0 - exp(-depths.forward));
    return Part(seen.straight, lit * irradiance * gained, depth);
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
    let span = cell_span(lattice, id);
    var fluence = vec3f(0.0);
    var flux = mat3x3f();   // columns x, y, z of rgb
    // Each light at eight points of the cell, or at a few where there are many lights.
    for (var i = 0u; i < params.light_count; i++) {
        let light = lights[i];
        var sum = vec3f(0.0);
        var passed = vec4f(0.0);
        for (var k = 0u; k < 8u; k += params.stride) {
            // Of few parts the next light takes others.
            let turned = (k + select(0u, 3u * i, params.stride > 1u)) & 7u;
            let part = forward_part(light, i, id, span, turned);
            sum += part.gained;
            passed += vec4f(part.straight + part.gained, part.depth);
        }
        sum *= f32(params.stride) / 8.0;
        store_light(id, i, f32(params.stride) / 8.0 * passed);
        let along = lattice_from_world(lattice, travel_of(light, span));
        fluence += sum;
        flux += mat3x3f(sum * along.x, sum * along.y, sum * along.z);
    }
    // Power units: fluence and flux times the cell's volume, W m.
    let volume = lattice.cell * lattice.cell * lattice.cell;
    let cells = lattice.count.x * lattice.count.y * lattice.count.z;
    let cell = (id.z * lattice.count.y + id.y) * lattice.count.x + id.x;
    for (var c = 0u; c < 3u; c++) {
        let index = c * cells + cell;
        forward[index] = base[index]
            + volume * vec4f(fluence[c], flux[0][c], flux[1][c], flux[2][c]);
    }
}
