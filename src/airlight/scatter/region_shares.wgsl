// What each cell of a region is still to get of what is under way in all of them, a lane for each region.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32,
        @builtin(workgroup_id) group: vec3u) {
    let first = group.x * REGIONS;
    var share = 0.0;
    for (var j = 0u; j < REGIONS; j++) {
        share += matrix[(first + lane) * REGIONS + j] * missing[first + j];
    }
    shares[first + lane] = share;
}
