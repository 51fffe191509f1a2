// Tiles of what lights shine on, put together: patches that send about as much to the image each. One workgroup.
//! use sampling
//! use light_guide

const PROBES = 4u;          // points of the image for each lane
const MOST_SPREAD = 1.5;    // of a patch: its radius over the root of its mean squared reach
const BLOCK = 16u;          // tiles that are seen alike, 4 x 4 of them

var<workgroup> sums: array<f32, WX>;

// The first tile whose running sum is beyond u, by bisection.
fn tile_at(u: f32) -> u32 {
    var low = 0u;
    var high = params.count - 1u;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (tiles[middle].running > u) { high = middle; } else { low = middle + 1u; }
    }
    return low;
}

// Of a tile's weight, what lies between two running sums.
fn between(tile: LitTile, low: f32, high: f32) -> f32 {
    return max(min(tile.running, high) - max(tile.running - tile.weight, low), 0.0);
}

fn put_together(low: f32, high: f32) -> LightPatch {
    // The tiles from `low` to `high` of the running weight, those at the ends in part: their means.
    let first = tile_at(low);
    var weight = 0.0;
    var flux = 0.0;
    var centre = vec3f(0.0);
    var normal = vec3f(0.0);
    let origin = tiles[first].centre;
    for (var i = first; i < params.count; i++) {
        let tile = tiles[i];
        let part = between(tile, low, high);
        weight += part;
        centre += part * (tile.centre - origin);
        normal += part * tile.normal;
        flux += part * tile.flux / max(tile.weight, 1e-30);
        if (tile.running >= high) { break; }
    }
    centre = origin + centre / max(weight, 1e-30);
    // A sphere around all of it, but for what is far off and sends little.
    var radius = 0.0;
    var squares = 0.0;
    for (var i = first; i < params.count; i++) {
        let tile = tiles[i];
        let part = between(tile, low, high);
        if (part > 0.0) {
            let reach = distance(tile.centre, centre) + tile.radius;
            radius = max(radius, reach);
            squares += part * reach * reach;
        }
        if (tile.running >= high) { break; }
    }
    radius = min(radius, MOST_SPREAD * sqrt(squares / max(weight, 1e-30)));
    return LightPatch(centre, radius, normal / max(weight, 1e-30), flux);
}

// Few points are looked for from each tile, so those around have their say.
fn weight_of(k: u32) -> f32 {
    let first = k / BLOCK * BLOCK;
    var sum = vec2f(0.0);
    for (var i = first; i < min(first + BLOCK, params.count); i++) {
        sum += tiles[i].flux * vec2f(tiles[i].seen, 1.0);
    }
    return tiles[k].flux * sum.x / max(sum.y, 1e-30);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(local_invocation_index) lane: u32) {
    // Every lane adds up a stretch of tiles, then the stretches of the lanes before.
    let each = (params.count + WX - 1u) / WX;
    let first = min(lane * each, params.count);
    let end = min(first + each, params.count);
    var own = 0.0;
    for (var i = first; i < end; i++) {
        let weight = weight_of(i);
        tiles[i].weight = weight;
        own += weight;
    }
    sums[lane] = own;
    workgroupBarrier();
    var running = 0.0;
    var total = 0.0;
    for (var i = 0u; i < WX; i++) {
        running += select(0.0, sums[i], i < lane);
        total += sums[i];
    }
    for (var i = first; i < end; i++) {
        running += tiles[i].weight;
        tiles[i].running = running;
    }
    storageBarrier();
    workgroupBarrier();
    // A lane for each patch: an equal part of the sum.
    if (lane < LIT_PATCHES) {
        var lit = LightPatch(vec3f(0.0), 0.0, vec3f(0.0), 0.0);
        if (total > 0.0) {
            let share = total / f32(LIT_PATCHES);
            lit = put_together(share * f32(lane), share * f32(lane + 1u));
        }
        lit_patches[lane] = lit;
    }
    if (lane == LIT_PATCHES) {
        lit_patches[lane] = LightPatch(vec3f(0.0), f32(LIT_PATCHES), vec3f(0.0), 0.0);
    }
    storageBarrier();
    workgroupBarrier();
    // Where rays by the cosine find the patches' light well enough, there is no guide.
    var found = vec2f(0.0);
    var cones: PatchCones;
    for (var k = 0u; k < PROBES; k++) {
        let hash = pcg_hash(lane * PROBES + k);
        let at = vec2u(hash % params.reduced.x, pcg_hash(hash) % params.reduced.y);
        let place = textureLoad(places, at, 0);
        let choice = guide_choice(place.xyz, textureLoad(normals, at, 0).xyz, 0.0, &cones);
        if (place.w > 0.0 && choice.total > 0.0) {
            found += vec2f(choice.found, 1.0);
        }
    }
    sums[lane] = found.x;
    workgroupBarrier();
    var all = vec2f(0.0);
    for (var i = 0u; i < WX; i++) { all.x += sums[i]; }
    workgroupBarrier();
    sums[lane] = found.y;
    workgroupBarrier();
    for (var i = 0u; i < WX; i++) { all.y += sums[i]; }
    workgroupBarrier();
    if (lane == 0u && (all.y <= 0.0 || !is_guided(all.x / max(all.y, 1.0)))) {
        lit_patches[LIT_PATCHES].radius = 0.0;
    }
}
