// The environment's direct light in cells, as the irradiance of six faces. A sky light comes from a disc: how
// much of it a cell sees is asked by taps as far beside the cell as the disc is wide from where its shadow
// is cast, on this side of walls (Fernando2005, percentage-closer soft shadows).
//! use map_visibility
//! use open_line

// Offsets inside a cell, in cells from its centre.
const SAMPLES = array<vec3f, 4>(
    vec3f(0.25, 0.25, 0.25), vec3f(-0.25, -0.25, 0.25), vec3f(-0.25, 0.25, -0.25),
    vec3f(0.25, -0.25, -0.25),
);
const TAPS = 16u;
const SURE_TAPS = 4u;   // where all of the disc is free, or none of it
const SEARCHES = 8u;
const FREE_CELLS = 8u;  // in which walls are looked for
const SKIN = 0.24;      // cells before a wall, which would shade itself in the maps' texels
const GOLDEN_TURN = vec2f(-0.73736888, 0.67549029);  // cosine and sine of the golden angle

// The next tap of a spiral over the unit disc, stratified by area.
fn turned(turn: vec2f) -> vec2f {
    return vec2f(turn.x * GOLDEN_TURN.x - turn.y * GOLDEN_TURN.y,
        turn.x * GOLDEN_TURN.y + turn.y * GOLDEN_TURN.x);
}

// Where a point lies in a view: u, v, depth; m along the lattice's axes, as all points here.
fn in_view(point: vec3f, view: LightViewData) -> vec3f {
    let clip = view.clip_from_world * vec4f(world_from_lattice(lattice, point), 1.0);
    return map_coordinates(clip.xyz);
}

fn depth_at(uv: vec2f, layer: u32) -> f32 {
    let size = vec2f(textureDimensions(depth));
    return textureLoad(depth, vec2u(clamp(uv * size, vec2f(0.0), size - 1.0)), layer, 0);
}

// The share of a disc of `radius` that something is before, and how far that is on average, in
// units of depth; `turn`: of the taps, so that lights' patterns do not agree.
fn blockers_before(coordinates: vec3f, radius: vec2f, turn: vec2f, layer: u32) -> vec2f {
    var sum = 0.0;
    var found = 0.0;
    var at = turn;
    for (var k = 0u; k < SEARCHES; k++) {
        let aside = radius * at * sqrt((f32(k) + 0.5) / f32(SEARCHES));
        let before = coordinates.z - depth_at(coordinates.xy + aside, layer);
        sum += max(0.0, before);
        found += select(0.0, 1.0, before > 0.0);
        at = turned(at);
    }
    return vec2f(found / f32(SEARCHES), sum / max(found, 1.0));
}

fn unwarped_metres(cell: vec3u, inside: vec3f) -> vec3f {
    return lattice.origin + lattice.cell * unwarped_coordinates(lattice, cell, inside);
}

// Where on an axis, m, the first wall from a cell is.
fn first_wall(id: vec3u, axis: u32, is_up: bool) -> f32 {
    var cell = id;
    for (var k = 0u; k < FREE_CELLS; k++) {
        if (open_face(vec3i(cell), axis, is_up) < 0.5) {
            return unwarped_metres(cell, select(vec3f(SKIN), vec3f(1.0 - SKIN), is_up))[axis];
        }
        let next = i32(cell[axis]) + select(-1, 1, is_up);
        cell[axis] = u32(clamp(next, 0, i32(lattice.count[axis]) - 1));
    }
    return select(-1e9, 1e9, is_up);
}

struct Cell {
    samples: array<vec3f, 4>,  // m
    centre: vec3f,            // m
    low: vec3f,               // m, of the free box around it
    high: vec3f,
}

// The share of a light that a cell sees.
fn share_of(cell: ptr<function, Cell>, i: u32) -> f32 {
    // How fast the disc widens with depth, in texture coordinates of the view.
    let view = row_of_views(i);
    let side = view.texel * vec2f(textureDimensions(depth));
    let metres = 1.0 / length(vec3f(view.clip_from_world[0].z, view.clip_from_world[1].z,
        view.clip_from_world[2].z));
    let widens = sky[i].direction.w * metres / side;
    // How far off what shades the cell is, and so how wide the disc is there.
    let turn = vec2f(cos(f32(i)), sin(f32(i)));
    let centre = in_view((*cell).centre, view);
    let found = blockers_before(centre, widens * centre.z, turn, i);
    let radius = widens * found.y;
    // Taps over that disc around points of the cell, on this side of its walls.
    let right = lattice_from_world(lattice, 2.0 * view.world_from_clip[0].xyz);
    let down = lattice_from_world(lattice, -2.0 * view.world_from_clip[1].xyz);
    let is_sure = found.x == 0.0 || found.x == 1.0;
    let taps = select(TAPS, SURE_TAPS, is_sure);
    var at = turn;
    var share = 0.0;
    var k = 0u;
    loop {
        let aside = radius * at * sqrt((f32(k) + 0.5) / f32(taps));
        let tap = (*cell).samples[k & 3u] + aside.x * right + aside.y * down;
        share += map_visibility(depth, compare, i, in_view(clamp(tap, (*cell).low, (*cell).high), view));
        at = turned(at);
        k++;
        if (k >= taps) {
            break;
        }
    }
    return share / f32(taps);
}

// The same cell in the lattice before it moved. Border cells see no wall on the far side.
fn previous_cell(id: vec3u) -> vec3i {
    return vec3i(id) + vec3i(params.shift_x, params.shift_y, params.shift_z);
}

fn is_inner(cell: vec3i) -> bool {
    return all(cell > vec3i(0)) && all(cell < vec3i(lattice.count) - 1);
}

fn copy_previous(id: vec3u) {
    let depth = textureDimensions(cube).z / 6u;
    for (var face = 0u; face < 6u; face++) {
        let layer = vec3u(0u, 0u, face * depth);
        let value = textureLoad(previous, previous_cell(id) + vec3i(layer), 0);
        textureStore(cube, id + layer + vec3u(0u, lattice.first_row, 0u), value);
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    // A lattice that moved has most of its cells already.
    if (params.has_previous != 0u && is_inner(vec3i(id)) && is_inner(previous_cell(id))) {
        copy_previous(id);
        return;
    }
    // Points of the cell, and the free box around it up to the first walls.
    var cell: Cell;
    cell.centre = unwarped_metres(id, vec3f(0.5));
    for (var k = 0u; k < 4u; k++) {
        cell.samples[k] = unwarped_metres(id, 0.5 + SAMPLES[k]);
    }
    cell.high = vec3f(first_wall(id, 0u, true), first_wall(id, 1u, true), first_wall(id, 2u, true));
    cell.low = vec3f(first_wall(id, 0u, false), first_wall(id, 1u, false), first_wall(id, 2u, false));
    // The irradiance of each light on the six faces (McTaggart2004).
    var faces = array<vec3f, 6>();
    for (var i = 0u; i < params.lights; i++) {
        let e = sky[i].irradiance.rgb * share_of(&cell, i);
        let towards = lattice_from_world(lattice, -sky[i].direction.xyz);
        faces[0] += e * max(0.0, towards.x);
        faces[1] += e * max(0.0, -towards.x);
        faces[2] += e * max(0.0, towards.y);
        faces[3] += e * max(0.0, -towards.y);
        faces[4] += e * max(0.0, towards.z);
        faces[5] += e * max(0.0, -towards.z);
    }
    // The faces lie one behind the other along z.
    for (var face = 0u; face < 6u; face++) {
        let texel = id + vec3u(0u, lattice.first_row, face * textureDimensions(cube).z / 6u);
        textureStore(cube, texel, vec4f(faces[face], 1.0));
    }
}
