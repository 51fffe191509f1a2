// The light of two cells along x in all channels, (a, b) a column each, and a cell's faces.
//! use cell_pairs

override IS_ADDED: bool = false;        // to `added`

struct Faces { side: vec4u, rest: vec4u }
struct Pair { a: mat3x4f, b: mat3x4f }

fn faces_at(cell: u32) -> Faces {
    let both = cell_pair(faces[cell]);
    return Faces(bitcast<vec4u>(both.a), bitcast<vec4u>(both.b));
}

fn two(x: CellPair, y: CellPair, z: CellPair) -> Pair {
    return Pair(mat3x4f(x.a, y.a, z.a), mat3x4f(x.b, y.b, z.b));
}

fn light_at(cell: u32) -> Pair {
    let channel = params.count.x * params.count.y * params.count.z;
    return two(cell_pair(before[cell >> 1u]), cell_pair(before[(cell + channel) >> 1u]),
        cell_pair(before[(cell + 2u * channel) >> 1u]));
}

fn put(cell: u32, a: mat3x4f, b: mat3x4f) {
    let channel = params.count.x * params.count.y * params.count.z;
    let place = vec3u(cell, cell + channel, cell + 2u * channel) >> vec3u(1u);
    var light = Pair(a, b);
    if (IS_ADDED) {
        let more = two(cell_pair(added[place.x]), cell_pair(added[place.y]),
            cell_pair(added[place.z]));
        light = Pair(a + more.a, b + more.b);
    }
    after[place.x] = cell_pair_bits(light.a[0], light.b[0]);
    after[place.y] = cell_pair_bits(light.a[1], light.b[1]);
    after[place.z] = cell_pair_bits(light.a[2], light.b[2]);
}

fn lane_before(v: mat3x4f) -> mat3x4f {
    return mat3x4f(subgroupShuffleUp(v[0], 1u), subgroupShuffleUp(v[1], 1u),
        subgroupShuffleUp(v[2], 1u));
}

fn lane_after(v: mat3x4f) -> mat3x4f {
    return mat3x4f(subgroupShuffleDown(v[0], 1u), subgroupShuffleDown(v[1], 1u),
        subgroupShuffleDown(v[2], 1u));
}

// Nothing instead of `v` where it is not there: what lanes without work hold may be no number.
fn only_if(v: mat3x4f, is_there: bool) -> mat3x4f {
    let none = vec4f(0.0);
    return mat3x4f(select(none, v[0], is_there), select(none, v[1], is_there),
        select(none, v[2], is_there));
}
