// Where in each box of the regions' grid a region begins, a workgroup for each box: of the cells without a region the one with
// the fewest closed faces, and of these the nearest to the middle; and how many such cells there are.
// maths.regions.flooded is the NumPy twin.
//! use open_both_ways

const UNREACHED = 0xffffffffu;

var<workgroup> keys: array<u32, WX>;
var<workgroup> counts: array<u32, WX>;

fn closed_faces(cell: vec3u) -> u32 {
    var closed = 0u;
    for (var hop = 0u; hop < 6u; hop++) {
        closed += select(1u, 0u, open_both_ways(cell, hop));
    }
    return closed;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32,
        @builtin(workgroup_id) group: vec3u) {
    // The box's cells, and its middle.
    let part = cell_at_index(params.regions, group.x);
    let first = (part * params.count + params.regions - 1u) / params.regions;
    let size = ((part + 1u) * params.count + params.regions - 1u) / params.regions - first;
    let middle = (2u * part + 1u) * params.count / (2u * params.regions);
    // Fewest closed faces, then nearest, then first: in one number, of which each lane finds its least.
    var key = UNREACHED;
    var count = 0u;
    for (var k = lane; k < size.x * size.y * size.z; k += WX) {
        let cell = first + cell_at_index(size, k);
        let is_free = params.turn == 0u || regions[cell_in(params.count, cell)] == UNREACHED;
        let closed = closed_faces(cell);
        if (is_free && closed < 6u) {
            let off = vec3u(abs(vec3i(cell) - vec3i(middle)));
            key = min(key, (closed << 25u) + ((off.x + off.y + off.z) << 18u) + k);
            count++;
        }
    }
    keys[lane] = key;
    counts[lane] = count;
    workgroupBarrier();
    // The least of all lanes, whose last bits are the cell's number in the box.
    if (lane == 0u) {
        for (var i = 1u; i < WX; i++) {
            key = min(key, keys[i]);
            count += counts[i];
        }
        let cell = first + cell_at_index(size, key & 0x3ffffu);
        seeds[group.x] = vec2u(select(UNREACHED, cell_in(params.count, cell), count > 0u), count);
    }
}
