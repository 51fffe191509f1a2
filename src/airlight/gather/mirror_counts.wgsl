// How many rays of a batch a segment has: so many rows of the images of hits are lit. One invocation.
//! use counted_rows

@compute @workgroup_size(WX, WY, WZ) fn main() {
    // The first segment has those of the list from the batch's first on, later ones what the one before sent on.
    let before = select(params.first, 0u, params.segment > 0u);
    let all = atomicLoad(&found[params.segment]);
    let rays = min(all - min(all, before), params.batch.x * params.batch.y);
    store_counted_rows((rays + params.batch.x - 1u) / params.batch.x, params.batch);
    atomicStore(&found[params.segment + 1u], 0u);
}
