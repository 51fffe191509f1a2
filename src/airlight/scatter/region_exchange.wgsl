// Row i of I - M between regions, a workgroup for each region and channel: with 1 W in each cell of region j, without
// direction, what of the power in region i is still missing after a step (i = j), or comes there (negative).
//! use step26
//! use channel_cells

// Sums in fixed point do not depend on the order of their parts.
var<workgroup> row: array<atomic<i32>, REGIONS>;

const UNITS = 536870912.0;      // of all power of a region's cells, and as much again of their neighbours'
const SLOWEST = 0.001;          // light is lost within so many steps, or a closed white room would have no answer

fn cell_with(at: vec3i, channel: u32) -> Cell {
    if (!IS_VARIED) {
        return homogeneous_cell(coefficients[params.row + channel].gain);
    }
    let inside = vec3u(clamp(at, vec3i(0), vec3i(params.count) - 1));
    return varied_cell(vec4f(1.0), medium[index_in(params.count, inside, channel)]);
}

fn cell_beside(at: vec3i, channel: u32, step: vec3i) -> Cell {
    return cell_with(at + step, channel);
}

fn region_at(at: vec3i) -> u32 {
    if (any(at < vec3i(0)) || any(at >= vec3i(params.count))) {
        return 255u;
    }
    return regions[index_in(params.count, vec3u(at), 0u)] & 255u;
}

// How open a hop is, of the two packs of a cell from `first` on.
fn open_share(first: u32, hop: u32) -> f32 {
    if (!HAS_WALLS) {
        return 1.0;
    }
    return unpack4x8unorm(packs[first + hop / 16u][(hop / 4u) & 3u])[hop & 3u];
}

// Adds what a cell of `region` keeps of its light and gets, by the region that it comes from: `exchange` of step26, of
// light without direction.
fn add_cell(cell: u32, region: u32, channel: u32, units: f32) {
    let at = vec3i(cell_at_index(params.count, cell));
    let own = cell_with(at, channel);
    var c = coefficients[params.row + channel];
    if (IS_VARIED && HANDED_ON == 0.0) {
        c = varied_coefficients(own);
    }
    // What the walls around it reflect.
    var white = 0.0;
    if (HAS_WALLS) {
        white = unpack4x8unorm(packs[4u * cell + 3u].w)[channel];
    }
    var kept = 0.0;
    for (var hop = 0u; hop < 27u; hop++) {
        if (hop == 13u) {
            continue;
        }
        let step = hop_offset(hop);
        let k = hop_kind(step);
        let far = cell_beside(at, channel, step);
        // Its own light, through the open share and back from the other; then the neighbour's.
        let open = open_share(4u * cell + 2u, hop);
        kept += open * (c.kept[k] + own.q[k] * far.w[k]) + (1.0 - open) * (c.stopped[k] + white * c.returned[k]);
        let came = open_share(4u * cell, hop) * (far.u[k] + far.q[k] * c.arriving[k]);
        let sender = region_at(at + step);
        if (sender == region) {
            kept += came;
        } else if (sender < REGIONS) {
            atomicAdd(&row[sender], i32(round(came * units)));
        }
    }
    atomicAdd(&row[region], i32(round(kept * units)));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32,
        @builtin(workgroup_id) group: vec3u) {
    let region = group.x;
    let channel = group.y;
    atomicStore(&row[lane], 0);
    workgroupBarrier();
    // In units in which all power of the region fits.
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
