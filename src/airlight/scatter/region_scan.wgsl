// Where each region's cells begin in the list of members, and those of each run of cells among them; a lane for each region.

var<workgroup> totals: array<u32, REGIONS>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32) {
    // Of the region: what runs before hold, then all.
    var total = 0u;
    for (var run = 0u; run < params.runs; run++) {
        let index = lane * params.runs + run;
        let count = firsts[index];
        firsts[index] = total;
        total += count;
    }
    totals[lane] = total;
    workgroupBarrier();
    // The regions before it come first.
    var start = 0u;
    for (var region = 0u; region < lane; region++) {
        start += totals[region];
    }
    for (var run = 0u; run < params.runs; run++) {
        firsts[lane * params.runs + run] += start;
    }
    starts[lane] = start;
    if (lane == REGIONS - 1u) {
        starts[REGIONS] = start + total;
    }
}
