// How many cells of each region there are in a run of cells: the first pass of a sort by regions.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.runs) {
        return;
    }
    var counts: array<u32, REGIONS>;
    for (var cell = id.x * RUN; cell < min((id.x + 1u) * RUN, params.cells); cell++) {
        let region = regions[cell] & 255u;
        if (region < REGIONS) {
            counts[region]++;
        }
    }
    for (var region = 0u; region < REGIONS; region++) {
        firsts[region * params.runs + id.x] = counts[region];
    }
}
