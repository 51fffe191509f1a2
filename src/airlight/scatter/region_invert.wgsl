// The inverse of a channel's matrix by Gauss and Jordan, a column for each lane. Columns lose power, so that diagonals are
// the largest and no pivot is looked for. What the last step has done already is taken off (maths.regions.gain).

var<workgroup> pivots: array<f32, REGIONS>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32,
        @builtin(workgroup_id) group: vec3u) {
    let first = group.x * REGIONS * REGIONS + lane;
    var column: array<f32, REGIONS>;
    for (var r = 0u; r < REGIONS; r++) {
        column[r] = matrix[first + r * REGIONS];
    }
    // Each column in turn is the pivot, which its lane hands to all others.
    for (var k = 0u; k < REGIONS; k++) {
        if (lane == k) {
            pivots = column;
        }
        workgroupBarrier();
        let scale = 1.0 / pivots[k];
        let is_pivot = lane == k;
        let own = select(column[k] * scale, scale, is_pivot);
        for (var r = 0u; r < REGIONS; r++) {
            column[r] = select(column[r], 0.0, is_pivot) - pivots[r] * own;
        }
        column[k] = own;
        workgroupBarrier();
    }
    column[lane] -= 1.0 / f32(max(starts[lane + 1u] - starts[lane], 1u));
    for (var r = 0u; r < REGIONS; r++) {
        matrix[first + r * REGIONS] = column[r];
    }
}
