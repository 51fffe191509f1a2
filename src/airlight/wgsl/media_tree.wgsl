// Which media a ray or a point may meet: a walk through the tree of their boxes (maths/box_tree.py), whose nodes lie
// in the rows of `media`, two each. Few media are all taken in turn. A walk goes
//     var node = 0u;
//     for (var v = 0u; v < MEDIA_NODES; v++) {
//         let visit = visit_on_ray(node, ray);
//         node = visit.next;
//         if (visit.is_done) { break; }
//         if (visit.is_skipped) { continue; }
//         .. visit.medium ..
//     }
// The count bounds it: without it, lavapipe's lanes that are through go round until its budget for loops is spent, and
// all later loops end after one turn.
// The root's `after` is no node, and says how many blocks there are of lists of paths (media/media_tree.py).
// The including pass adds MEDIA_COUNT, MEDIA_NODES and HAS_MEDIA_TREE (media/media_slots.py).

const NO_MEDIUM = 65535u;

// A ray of the length `reach`, m, as walks need it.
struct WalkedRay { origin: vec3f, inverse: vec3f, reach: f32 }

fn walked_ray(origin: vec3f, direction: vec3f, reach: f32) -> WalkedRay {
    let safe = select(direction, vec3f(1e-30), abs(direction) < vec3f(1e-30));
    return WalkedRay(origin, 1.0 / safe, reach);
}

// A box, the node after it where it is skipped, and the medium of a leaf.
struct MediaNode { low: vec3f, after: u32, high: vec3f, medium: u32 }

fn media_node(n: u32) -> MediaNode {
    let pair = row_of_media(n >> 1u).nodes;
    let is_second = (n & 1u) == 1u;
    let a = select(pair[0], pair[2], is_second);
    let b = select(pair[1], pair[3], is_second);
    return MediaNode(a.xyz, u32(a.w), b.xyz, u32(b.w));
}

// Of a node: whether there is none left, whether it is no leaf or not met, the medium of the leaf, and the node to go
// on with.
struct MediaVisit { next: u32, medium: u32, is_skipped: bool, is_done: bool }

fn visited(node: MediaNode, n: u32, is_met: bool) -> MediaVisit {
    return MediaVisit(select(node.after, n + 1u, is_met), node.medium, !is_met || node.medium == NO_MEDIUM,
        n >= MEDIA_NODES);
}

// Where a ray is in the node's box; x > y where it misses.
fn span_in_box(node: MediaNode, ray: WalkedRay) -> vec2f {
    let a = (node.low - ray.origin) * ray.inverse;
    let b = (node.high - ray.origin) * ray.inverse;
    let near = min(a, b);
    let far = max(a, b);
    return vec2f(max(max(near.x, near.y), max(near.z, 0.0)), min(min(far.x, far.y), min(far.z, ray.reach)));
}

// Is the node's box on a ray?
fn visit_on_ray(n: u32, ray: WalkedRay) -> MediaVisit {
    if (!HAS_MEDIA_TREE) {
        return MediaVisit(n + 1u, n, false, false);
    }
    let node = media_node(n);
    let span = span_in_box(node, ray);
    return visited(node, n, span.x <= span.y);
}

// Is it within `reach` of a point along each axis?
fn visit_near(n: u32, p: vec3f, reach: f32) -> MediaVisit {
    if (!HAS_MEDIA_TREE) {
        return MediaVisit(n + 1u, n, false, false);
    }
    let node = media_node(n);
    return visited(node, n, all(p >= node.low - reach) && all(p <= node.high + reach));
}
