// The iteration of propagate.wgsl for CPU adapters, whose invocations are lanes of vectors and whose cost
// is loads: lanes share a row of cells. Each marches a tile of 4 x 2 columns along z, reads two cells at
// once, and has those beside its tile from the lanes beside it. The lattice's x is even.
//! use cell_pairs
//! use step26
//! use cell_order

const WIDTH = 4u;
const HEIGHT = 2u;

// A tile's layer of cells with all that touch them: rows y - 1 to y + 2, columns x - 1 to x + 4.
alias Row = array<Cell, 6>;
alias Layer = array<Row, 4>;

// The layer below the one that is stepped, that one, and the one above.
var<private> below: Layer;
var<private> here: Layer;
var<private> above: Layer;
var<private> table: StepCoefficients;

// `at` is a column and row of the tile.
fn cell_beside(at: vec3i, channel: u32, step: vec3i) -> Cell {
    let y = at.y + 1 + step.y;
    let x = at.x + 1 + step.x;
    switch step.z {
        case -1: { return below[y][x]; }
        case 0: { return here[y][x]; }
        default: { return above[y][x]; }
    }
}

fn medium_pair(pair: u32) -> vec2<u64> {
    if (IS_VARIED) {
        return medium[pair];
    }
    return vec2<u64>();
}

// A cell that is read, without light where it is not `is_there`.
fn cell_of(state: vec4f, medium_bits: u64, gain: vec4f, is_there: bool) -> Cell {
    let seen = select(vec4f(0.0), state, is_there);
    if (IS_VARIED) {
        let words = vec2u(u32(medium_bits), u32(medium_bits >> 32u));
        return varied_cell(seen, bitcast<vec2f>(words));
    }
    return homogeneous_cell(seen * gain);
}

// The cell that the lane before this one holds, or the one after it.
fn of_lane_before(cell: Cell) -> Cell {
    let state = subgroupShuffleUp(cell.state, 1u);
    if (IS_VARIED) {
        return Cell(state, subgroupShuffleUp(cell.q, 1u), subgroupShuffleUp(cell.u, 1u),
            subgroupShuffleUp(cell.w, 1u), subgroupShuffleUp(cell.ahead, 1u));
    }
    return homogeneous_cell(state);
}

fn of_lane_after(cell: Cell) -> Cell {
    let state = subgroupShuffleDown(cell.state, 1u);
    if (IS_VARIED) {
        return Cell(state, subgroupShuffleDown(cell.q, 1u), subgroupShuffleDown(cell.u, 1u),
            subgroupShuffleDown(cell.w, 1u), subgroupShuffleDown(cell.ahead, 1u));
    }
    return homogeneous_cell(state);
}

// The cell, or what is beyond the border cell: no light, in the same medium.
fn or_beyond(cell: Cell, border: Cell, is_beyond: bool) -> Cell {
    return Cell(select(cell.state, vec4f(0.0), is_beyond), select(cell.q, border.q, is_beyond),
        select(cell.u, border.u, is_beyond), select(cell.w, border.w, is_beyond),
        select(cell.ahead, border.ahead, is_beyond));
}

// The tile's cells of the row that begins at cell `first`, and one on either side.
fn row_at(first: u32, x: u32, gain: vec4f, is_there: bool) -> Row {
    // Two pairs. One beyond the row's end is read at its end: no light, the medium of the last cell.
    let nx = params.count.x;
    let has_two = x + 2u < nx;
    let i = (first + x) >> 1u;
    let k = (first + min(x + 2u, nx - 2u)) >> 1u;
    let left = cell_pair(before[i]);
    let right = cell_pair(before[k]);
    let left_medium = medium_pair(i);
    let right_medium = medium_pair(k);
    let a = cell_of(left.a, left_medium.x, gain, is_there);
    let b = cell_of(left.b, left_medium.y, gain, is_there);
    let c = cell_of(right.a, select(right_medium.y, right_medium.x, has_two), gain, is_there && has_two);
    let d = cell_of(right.b, right_medium.y, gain, is_there && has_two);
    // The cells of the lanes beside this one; the first and the last lane read what another vector has.
    var west = of_lane_before(d);
    var east = of_lane_after(a);
    let lane = (x / WIDTH) % WX;
    let is_first = x == 0u;
    let is_last = x + WIDTH >= nx;
    if ((lane == 0u && !is_first) || (lane == WX - 1u && !is_last)) {
        let beside = select(k + 1u, i - 1u, lane == 0u);
        let pair = cell_pair(before[beside]);
        let bits = medium_pair(beside);
        let cell = cell_of(select(pair.a, pair.b, lane == 0u), select(bits.x, bits.y, lane == 0u), gain,
            is_there);
        if (lane == 0u) {
            west = cell;
        } else {
            east = cell;
        }
    }
    return Row(or_beyond(west, a, is_first), a, b, c, d, or_beyond(east, d, is_last));
}

// Layer z of the lattice around the tile at `at`; no light where it is not `is_there`.
fn layer_at(z: u32, at: vec2u, channel: u32, is_there: bool) -> Layer {
    let n = params.count;
    let first = (channel * n.z + z) * n.y;
    return Layer(
        row_at((first + max(at.y, 1u) - 1u) * n.x, at.x, table.gain, is_there && at.y > 0u),
        row_at((first + at.y) * n.x, at.x, table.gain, is_there),
        row_at((first + min(at.y + 1u, n.y - 1u)) * n.x, at.x, table.gain, is_there && at.y + 1u < n.y),
        row_at((first + min(at.y + 2u, n.y - 1u)) * n.x, at.x, table.gain, is_there && at.y + 2u < n.y));
}

fn walls_at(cell: u32, channel: u32) -> Walls {
    if (!HAS_WALLS) {
        return no_walls();
    }
    let entering = cell_pair(packs[2u * cell]);
    let leaving = cell_pair(packs[2u * cell + 1u]);
    return unpacked_walls(array<vec4u, 4>(bitcast<vec4u>(entering.a), bitcast<vec4u>(entering.b),
        bitcast<vec4u>(leaving.a), bitcast<vec4u>(leaving.b)), channel);
}

// K before in the tile's cell at `at`, of the lattice's number `cell`.
fn stepped_cell(cell: u32, at: vec3i, channel: u32) -> vec4f {
    let own = cell_beside(at, channel, vec3i(0));
    var c = table;
    if (IS_VARIED && HANDED_ON == 0.0) {
        c = varied_coefficients(own);
    }
    var walls = walls_at(cell, channel);
    return exchanged(Here(at, channel, own, c), &walls);
}

// Steps the tile's two cells from column x of row y on, the first of which has the number `cell`.
fn step_pair(cell: u32, x: i32, y: i32, channel: u32, is_there: bool) {
    let a = stepped_cell(cell, vec3i(x, y, 0), channel);
    let b = stepped_cell(cell + 1u, vec3i(x + 1, y, 0), channel);
    if (is_there) {
        let n = params.count;
        let pair = (channel * n.x * n.y * n.z + cell) >> 1u;
        let given = cell_pair(source[pair]);
        after[pair] = cell_pair_bits(given.a + a, given.b + b);
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    // A tile of columns, and the slab of layers that this invocation marches.
    let n = params.count;
    let slab = (n.z + params.slabs - 1u) / params.slabs;
    let channel = id.z / params.slabs;
    let at = vec2u(WIDTH, HEIGHT) * id.xy;
    let z_first = (id.z % params.slabs) * slab;
    if (channel >= 3u || at.x >= n.x || at.y >= n.y || z_first >= n.z) {
        return;
    }
    let z_end = min(z_first + slab, n.z);
    let has_two = at.x + 2u < n.x;
    let has_row = at.y + 1u < n.y;
    table = coefficients[params.row + channel];
    // Each layer is read once. The loop tests at its end, where CPU adapters leave it sooner.
    below = layer_at(max(z_first, 1u) - 1u, at, channel, z_first > 0u);
    here = layer_at(z_first, at, channel, true);
    var z = z_first;
    loop {
        above = layer_at(min(z + 1u, n.z - 1u), at, channel, z + 1u < n.z);
        let cell = cell_in(n, vec3u(at, z));
        step_pair(cell, 0, 0, channel, true);
        step_pair(cell + 2u, 2, 0, channel, has_two);
        step_pair(cell + n.x, 0, 1, channel, has_row);
        step_pair(cell + n.x + 2u, 2, 1, channel, has_row && has_two);
        below = here;
        here = above;
        z++;
        if (z >= z_end) {
            break;
        }
    }
}
