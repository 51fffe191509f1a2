// Which hops between a cell and the next along +x, +y, +z walls stop, a bit for each: surfaces that face the hop lie
// between their middles (`crossed`), and there is no way around them from middle to middle near the two. The faces that a wall aslant to the cells closes so are a
// staircase without a gap, whatever share of each face it covers; what light can go around, a pole or a table, closes
// no more than it covers. Twin: maths.parted_cells.parted.
//! use cell_order

// The cells that the way may take: 8 along the axis, the two in the middle, and 7 x 7 across it. A layer is
// a row of 8 bits for each of 7 cells; each layer lies in two words.
const REACH = 3;
const LAYERS = 7u;
const MOST_TURNS = 64u;
const FIRST_HOP = 3u;       // as wgsl/crossed_cells.wgsl has them

// Of the cells: where the way leads on along the axis, across it and up.
var<private> along: array<vec2u, LAYERS>;
var<private> across: array<vec2u, LAYERS>;
var<private> up: array<vec2u, LAYERS>;
var<private> reached: array<vec2u, LAYERS>;

fn bit_of(row: u32, column: u32) -> vec2u {
    let bit = 1u << (8u * (row & 3u) + column);
    return select(vec2u(bit, 0u), vec2u(0u, bit), row > 3u);
}

// The faces of a cell that are crossed; what leaves the lattice does not come back.
fn crossed_at(cell: vec3i) -> u32 {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(params.count))) {
        return 7u;
    }
    return crossed[cell_in(params.count, vec3u(cell))];
}

// Moved by a row, to the next cells across or back.
fn row_on(layer: vec2u) -> vec2u {
    return vec2u(layer.x << 8u, (layer.y << 8u) | (layer.x >> 24u));
}

fn row_back(layer: vec2u) -> vec2u {
    return vec2u((layer.x >> 8u) | (layer.y << 24u), layer.y >> 8u);
}

fn open_ways(cell: vec3i, axis: u32) {
    let b = (axis + 1u) % 3u;
    let c = (axis + 2u) % 3u;
    for (var layer = 0u; layer < LAYERS; layer++) {
        along[layer] = vec2u(0u);
        across[layer] = vec2u(0u);
        up[layer] = vec2u(0u);
        reached[layer] = vec2u(0u);
        for (var k = 0u; k < 8u * LAYERS; k++) {
            let row = k / 8u;
            let column = k % 8u;
            var at = cell;
            at[axis] += i32(column) - REACH;
            at[b] += i32(row) - REACH;
            at[c] += i32(layer) - REACH;
            // Not beyond the last cell that there is room for.
            let is_open = vec3u(~crossed_at(at)) >> vec3u(axis, b, c);
            let own = bit_of(row, column);
            along[layer] |= select(vec2u(0u), own, (is_open.x & 1u) != 0u && column < 7u);
            across[layer] |= select(vec2u(0u), own, (is_open.y & 1u) != 0u && row + 1u < LAYERS);
            up[layer] |= select(vec2u(0u), own, (is_open.z & 1u) != 0u);
        }
    }
}

// What is reached in a turn from what was; whether that is more.
fn grows() -> bool {
    var is_more = false;
    for (var layer = 0u; layer < LAYERS; layer++) {
        let before = reached[layer];
        var now = before;
        now |= ((now & along[layer]) << vec2u(1u)) | ((now >> vec2u(1u)) & along[layer]);
        now |= row_on(now & across[layer]) | (row_back(now) & across[layer]);
        if (layer > 0u) {
            now |= reached[layer - 1u] & up[layer - 1u];
        }
        if (layer + 1u < LAYERS) {
            now |= reached[layer + 1u] & up[layer];
        }
        is_more = is_more || any(now != before);
        reached[layer] = now;
    }
    return is_more;
}

fn is_parted(cell: vec3i, axis: u32) -> bool {
    open_ways(cell, axis);
    let middle = u32(REACH);
    reached[middle] = bit_of(middle, middle);
    let goal = bit_of(middle, middle + 1u);
    for (var turn = 0u; turn < MOST_TURNS && grows() && all((reached[middle] & goal) == vec2u(0u)); turn++) {}
    return all((reached[middle] & goal) == vec2u(0u));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cell = cell_in(params.count, id);
    let here = crossed[cell];
    var found = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        if (((here >> axis) & 1u) != 0u && is_parted(vec3i(id), axis)) {
            found |= (here >> FIRST_HOP) & (3u << (2u * axis));
        }
    }
    parted[cell] = found;
}
