// change = the summed states whose track is an eighth of the coarse cell's. Where a wall
// runs through a coarse cell its light goes to the fine cells by what they hold already, so that
// none appears behind the wall.

//! use hops26

const CLOSED = 0.05;

// The smallest open share among the faces inside the coarse cell that holds `at`.
fn inner_face_visibility(at: vec3u) -> f32 {
    let f = params.fine;
    let first = 2u * (at / 2u);
    var open = 1.0;
    for (var k = 0u; k < 8u; k++) {
        let side = vec3u(k & 1u, (k >> 1u) & 1u, k >> 2u);
        let p = first + side;
        if (any(p >= f)) {
            continue;
        }
        // A hop along +x enters through a cell's low face: inside for the upper of two cells.
        let packed = face_visibility[(p.z * f.y + p.y) * f.x + p.x];
        let xy = unpack4x8unorm(packed.x);
        let z = unpack4x8unorm(packed.y);
        let entered = vec3f(select(xy.y, xy.x, side.x == 1u), select(xy.w, xy.z, side.y == 1u),
            select(z.y, z.x, side.z == 1u));
        open = min(open, min(entered.x, min(entered.y, entered.z)));
    }
    return open;
}

// The share, times 8, of the coarse cell's light that `at` gets, by what it holds.
fn held_share(at: vec3u, channel: u32) -> f32 {
    let f = params.fine;
    let first = 2u * (at / 2u);
    var total = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let p = first + vec3u(k & 1u, (k >> 1u) & 1u, k >> 2u);
        if (all(p < f)) {
            total += max(0.0, sum[((channel * f.z + p.z) * f.y + p.y) * f.x + p.x].x);
        }
    }
    let own = max(0.0, sum[((channel * f.z + at.z) * f.y + at.y) * f.x + at.x].x);
    return select(0.0, 8.0 * own / total, total > 0.0);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let f = params.fine;
    let channel = id.z / f.z;
    if (id.x >= f.x || id.y >= f.y || channel >= 3u) {
        return;
    }
    let at = vec3u(id.xy, id.z % f.z);
    let index = ((channel * f.z + at.z) * f.y + at.y) * f.x + at.x;
    let c = at / 2u;
    let n = params.coarse;
    var per_hop = params.track[channel];
    if ((params.flags & 2u) != 0u) {
        per_hop = mean_track(vec3f(medium[index].y), params.cell).x;
    }
    var share = 0.125 / per_hop;
    if ((params.flags & 1u) != 0u && inner_face_visibility(at) < 1.0 - CLOSED) {
        share *= held_share(at, channel);
    }
    let found = track[((channel * n.z + c.z) * n.y + c.y) * n.x + c.x];
    change[index] = share * vec4f(found.x, 3.0 / (RHO * RHO) * found.yzw);
}
