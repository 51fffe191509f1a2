// The cells of all regions, region by region, each in the order of cells: the last pass of a sort by regions.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.runs) {
        return;
    }
    for (var cell = id.x * RUN; cell < min((id.x + 1u) * RUN, params.cells); cell++) {
        let region = regions[cell] & 255u;
        if (region < REGIONS) {
            let index = region * params.runs + id.x;
            members[firsts[index]] = cell;
            firsts[index]++;
        }
    }
}
