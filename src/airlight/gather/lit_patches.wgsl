// Tiles of what lights shine on, put together to patches of those that are near to each other. One workgroup.
//! use sampling
//! use light_guide

const PROBES = 4u;          // points of the image for each lane
const MOST_SPREAD = 1.5;    // of a patch: its radius over the root of its mean squared reach
const BLOCK = 16u;          // tiles that are seen alike, 4 x 4 of them
const ALIKE = 0.8;          // cosine between the normals of such

const CANDIDATES = 64u;     // tiles of which some become centres
const EACH = WX / CANDIDATES;
const ROUNDS = 3u;          // of moving centres to the middles of what is nearest to them

var<workgroup> sums: array<f32, WX>;
// A tile for each lane, each for an equal part of all weight, and the patch it belongs to.
var<workgroup> chosen: array<u32, WX>;
var<workgroup> spheres: array<vec4f, WX>;           // m: centre, radius
var<workgroup> near2: array<f32, WX>;               // m^2: squared distance to the nearest of the patches' centres
var<workgroup> member_of: array<u32, WX>;
var<workgroup> centres: array<vec3f, LIT_PATCHES>;  // m

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

// The tiles' spheres, and squared distances at first: beyond any between two of them.
fn choose_tiles(lane: u32, total: f32) {
    chosen[lane] = tile_at(total * (f32(lane) + 0.5) / f32(WX));
    let tile = tiles[chosen[lane]];
    spheres[lane] = vec4f(tile.centre, tile.radius);
    workgroupBarrier();
    var far2 = 0.0;
    for (var i = 0u; i < WX; i++) {
        let offset = spheres[i].xyz - spheres[0].xyz;
        far2 = max(far2, dot(offset, offset));
    }
    near2[lane] = 4.0 * far2;
    workgroupBarrier();
}

// One after the other the tile that brings all of them nearest to a centre (greedy k-means).
fn choose_centres(lane: u32) {
    for (var k = 0u; k < LIT_PATCHES; k++) {
        // Every fourth tile may become one; lanes that are not asked cost nothing.
        if (lane < CANDIDATES) {
            var gain = 0.0;
            for (var i = 0u; i < WX; i++) {
                let offset = spheres[i].xyz - spheres[EACH * lane].xyz;
                gain += max(near2[i] - dot(offset, offset), 0.0);
            }
            sums[lane] = gain;
        }
        workgroupBarrier();
        if (lane == 0u) {
            var best = 0u;
            for (var i = 1u; i < CANDIDATES; i++) {
                best = select(best, i, sums[i] > sums[best]);
            }
            best *= EACH;
            centres[k] = spheres[best].xyz;
        }
        workgroupBarrier();
        let offset = centres[k] - spheres[lane].xyz;
        near2[lane] = min(near2[lane], dot(offset, offset));
        workgroupBarrier();
    }
}

// Each tile joins the nearest centre.
fn join(lane: u32) {
    var least2 = 1e30;
    for (var k = 0u; k < LIT_PATCHES; k++) {
        let offset = centres[k] - spheres[lane].xyz;
        let d2 = dot(offset, offset);
        if (d2 < least2) {
            least2 = d2;
            member_of[lane] = k;
        }
    }
    workgroupBarrier();
}

// A centre moves to the middle of its tiles (Lloyd1982).
fn move_centre(k: u32) {
    var sum = vec4f(0.0);
    for (var i = 0u; i < WX; i++) {
        if (member_of[i] == k) { sum += vec4f(spheres[i].xyz - centres[k], 1.0); }
    }
    centres[k] += sum.xyz / max(sum.w, 1.0);
}

fn put_together(k: u32, share: f32) -> LightPatch {
    // The sphere is around all of its tiles, but for what is far off and sends little.
    var out = LightPatch(centres[k], 0.0, vec3f(0.0), 0.0);
    var squares = 0.0;
    var count = 0.0;
    for (var i = 0u; i < WX; i++) {
        if (member_of[i] != k) { continue; }
        let tile = tiles[chosen[i]];
        let reach = distance(tile.centre, centres[k]) + tile.radius;
        out.radius = max(out.radius, reach);
        squares += reach * reach;
        out.normal += tile.normal;
        out.flux += tile.flux * share / max(tile.weight, 1e-30);
        count += 1.0;
    }
    out.radius = min(out.radius, MOST_SPREAD * sqrt(squares / max(count, 1.0)));
    out.normal /= max(count, 1.0);
    return out;
}

// Few points are looked for from each tile, so those around on about the same plane have their say.
fn weight_of(k: u32) -> f32 {
    let own = tiles[k];
    let first = k / BLOCK * BLOCK;
    var sum = vec2f(0.0);
    for (var i = first; i < min(first + BLOCK, params.count); i++) {
        let its = tiles[i];
        let off_plane = abs(dot(its.centre - own.centre, own.normal));
        if (dot(its.normal, own.normal) > ALIKE && off_plane <= own.radius) {
            sum += its.flux * vec2f(its.seen, 1.0);
        }
    }
    return own.flux * sum.x / max(sum.y, 1e-30);
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
    // A lane for each of the tiles that stand for all, then one for each patch of them.
    choose_tiles(lane, total);
    choose_centres(lane);
    join(lane);
    for (var round = 0u; round < ROUNDS; round++) {
        if (lane < LIT_PATCHES) { move_centre(lane); }
        workgroupBarrier();
        join(lane);
    }
    if (lane < LIT_PATCHES) {
        var lit = LightPatch(vec3f(0.0), 0.0, vec3f(0.0), 0.0);
        if (total > 0.0) { lit = put_together(lane, total / f32(WX)); }
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
