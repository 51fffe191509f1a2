// Row i of I - M between regions, a workgroup for each region and channel: with 1 W in each cell of region j, without
// direction, what of the power in region i is still missing after a step (i = j), or comes there (negative).
//! use step26
//! use channel_cells

// Sums in fixed point do not depend on the order of their parts.
var<workgroup> row: array<atomic<i32>, REGIONS>;

const UNITS = 536870912.0;      // of all power of a region's cells, and as much again of their neighbours'
const SLOWEST = 0.001;          // light is lost within so many steps, or a closed white room would have no answer

fn cell_with(at: vec3i, channel: u32, power: f32) -> Cell {
    let state = vec4f(power, 0.0, 0.0, 0.0);
    let inside = vec3u(clamp(at, vec3i(0), vec3i(params.count) - 1));
    if (IS_VARIED) {
        return varied_cell(state, medium[index_in(params.count, inside, channel)]);
    }
    return homogeneous_cell(state * coefficients[params.row + channel].gain);
}

fn cell_beside(at: vec3i, channel: u32, step: vec3i) -> Cell {
    return cell_with(at + step, channel, 1.0);
}

fn walls_at(cell: u32, channel: u32) -> Walls {
    if (!HAS_WALLS) {
        return no_walls();
    }
    let p = 4u * cell;
    return unpacked_walls(array<vec4u, 4>(packs[p], packs[p + 1u], packs[p + 2u], packs[p + 3u]), channel);
}

fn region_at(at: vec3i) -> u32 {
    if (any(at < vec3i(0)) || any(at >= vec3i(params.count))) {
        return 255u;
    }
    return regions[index_in(params.count, vec3u(at), 0u)] & 255u;
}

// Adds what a cell of `region` keeps and gets, by the region that it comes from.
fn add_cell(cell: u32, region: u32, channel: u32, units: f32) {
    let at = vec3i(cell_at_index(params.count, cell));
    let own = cell_with(at, channel, 1.0);
    let no_own = cell_with(at, channel, 0.0);
    var c = coefficients[params.row + channel];
    if (IS_VARIED && HANDED_ON == 0.0) {
        c = varied_coefficients(own);
    }
    var walls = walls_at(cell, channel);
    var kept = vec4f(0.0);
    for (var hop = 0u; hop < 27u; hop++) {
        let step = hop_offset(hop);
        let far = region_at(at + step);
        if (hop == 13u) {
            continue;
        }
        if (far == region) {
            exchange(&kept, c, own, cell_beside(at, channel, step), &walls, step);
            continue;
        }
        exchange(&kept, c, own, cell_with(at + step, channel, 0.0), &walls, step);
        if (far < REGIONS) {
            var came = vec4f(0.0);
            exchange(&came, c, no_own, cell_beside(at, channel, step), &walls, step);
            atomicAdd(&row[far], i32(round(came.x * units)));
        }
    }
    atomicAdd(&row[region], i32(round(kept.x * units)));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32,
        @builtin(workgroup_id) group: vec3u) {
    let region = group.x;
    let channel = group.y;
    atomicStore(&row[lane], 0);
    workgroupBarrier();
    let count = f32(starts[region + 1u] - starts[region]);
    let units = UNITS / max(count, 1.0);
    for (var k = starts[region] + lane; k < starts[region + 1u]; k += WX) {
        add_cell(members[k], region, channel, units);
    }
    workgroupBarrier();
    // A region without cells stands by itself.
    let own = select(1.0, (1.0 + SLOWEST) * count, count > 0.0);
    matrix[(channel * REGIONS + region) * REGIONS + lane] = select(0.0, own, lane == region)
        - f32(atomicLoad(&row[lane])) / units;
}
