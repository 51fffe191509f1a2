// Which media may lie between a point and a light: from a list of the block of space that the point lies in, where the
// including pass has one (media/path_lists.py: HAS_PATH_LISTS, .. and `path_list`), else by the tree. A walk goes
//     var walk = walk_towards(index, p, path);
//     loop {
//         if (walk.medium != NO_MEDIUM) {
//             .. walk.medium ..
//         }
//         continuing {
//             step_towards(&walk);
//             break if walk.is_done;
//         }
//     }
// It asks at the end of a turn whether there is another: a CPU adapter runs all of a turn that is left at its head.
//! use media_tree
//! needs fn path_list(at: vec3u) -> vec4u

const LISTED_AT_ONCE = 128u;    // media in a texel of a list

struct LightWalk {
    medium: u32,        // the one that is met; NO_MEDIUM where this turn found none
    is_done: bool,
    turn: u32,
    ray: WalkedRay,     // of walks through the tree
    node: u32,          // the next one; of lists, media before those of this texel
    bits: vec4u,        // media of this texel that are still to come
    at: vec3u,          // the texel
}

// From p along `path` (its direction and length) towards the light in row `index`, at the first medium.
fn walk_towards(index: u32, p: vec3f, path: vec4f) -> LightWalk {
    var walk = LightWalk(NO_MEDIUM, false, 0u, walked_ray(p, path.xyz, path.w), 0u, vec4u(0u), vec3u(0u));
    if (HAS_PATH_LISTS) {
        // Light from beyond the box of all media meets what it meets from where it enters the box.
        let all = media_node(0u);
        let span = span_in_box(all, walk.ray);
        let q = p + span.x * path.xyz;
        let share = (q - all.low) / max(all.high - all.low, vec3f(1e-20));
        let blocks = (vec3u(all.after) >> vec3u(0u, 6u, 12u)) & vec3u(63u);
        let block = vec3u(clamp(vec3i(floor(share * vec3f(blocks))), vec3i(0), vec3i(blocks) - 1));
        walk.at = vec3u(block.y * blocks.x + block.x, block.z, index * PATH_TEXELS);
        let is_missed = span.x > span.y;
        walk.node = select(0u, MEDIA_COUNT, is_missed);
        walk.bits = select(path_list(walk.at), vec4u(0u), is_missed);
    }
    step_towards(&walk);
    return walk;
}

// Go to the next medium.
fn step_towards(walk: ptr<function, LightWalk>) {
    (*walk).turn += 1u;
    if (!HAS_PATH_LISTS) {
        let visit = visit_on_ray((*walk).node, (*walk).ray);
        (*walk).node = visit.next;
        (*walk).is_done = visit.is_done || (*walk).turn > MEDIA_VISITS;
        (*walk).medium = select(visit.medium, NO_MEDIUM, visit.is_skipped || visit.is_done);
        return;
    }
    // The lowest bit that is left of this texel's four words is the next medium.
    let bits = (*walk).bits;
    let is_any = bits != vec4u(0u);
    let word = select(select(select(3u, 2u, is_any.z), 1u, is_any.y), 0u, is_any.x);
    let lowest = select(select(select(bits.w, bits.z, is_any.z), bits.y, is_any.y), bits.x, is_any.x);
    (*walk).bits = select(bits, bits & (bits - 1u), vec4u(0u, 1u, 2u, 3u) == vec4u(word));
    (*walk).medium = select(NO_MEDIUM, (*walk).node + 32u * word + firstTrailingBit(lowest), lowest != 0u);
    if (lowest != 0u) {
        return;
    }
    // Of more media than a texel holds the list goes on in the next one.
    (*walk).node += LISTED_AT_ONCE;
    (*walk).is_done = (*walk).node >= MEDIA_COUNT || (*walk).turn > MEDIA_VISITS;
    if (PATH_TEXELS > 1u && !(*walk).is_done) {
        (*walk).at.z += 1u;
        (*walk).bits = path_list((*walk).at);
    }
}
