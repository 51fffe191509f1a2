// The orphan pixels of all blocks in a list, in the order of the blocks; where it holds fewer than there are, in each
// sample of the image others. One workgroup.
//! use gather_orphans
//! use orphans
//! use sampling

var<workgroup> sums: array<u32, WX>;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32) {
    // Every lane counts those of a stretch of blocks, then those of the lanes before.
    let blocks = blocks_of_image();
    let each = (blocks + WX - 1u) / WX;
    let first = min(lane * each, blocks);
    let end = min(first + each, blocks);
    var own = 0u;
    for (var i = first; i < end; i++) {
        own += choices[i].w;
    }
    sums[lane] = own;
    workgroupBarrier();
    var running = 0u;
    var total = 0u;
    for (var i = 0u; i < WX; i++) {
        running += select(0u, sums[i], i < lane);
        total += sums[i];
    }
    // The first of each block, and how many are listed; of each orphan its block, and which pixel of that it is.
    let phase = pcg_hash(params.sample) % max(total, 1u);
    for (var i = first; i < end; i++) {
        let chosen = choices[i];
        let start = listed_before(running, total, params.most, phase);
        var at = start;
        for (var k = 0u; k < chosen.w; k++) {
            let next = listed_before(running + k + 1u, total, params.most, phase);
            if (next > at) {
                orphans[blocks + at] = i | (chosen[k] << BLOCK_BITS);
            }
            at = next;
        }
        orphans[i] = (start << 2u) | (at - start);
        running += chosen.w;
    }
    for (var k = min(total, params.most) + lane; k < params.most; k += WX) {
        orphans[blocks + k] = NO_ORPHAN;
    }
}
