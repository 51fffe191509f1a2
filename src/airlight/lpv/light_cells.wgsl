// A cell's light in all channels, (a, b) a column each, and its faces: one by one.

override IS_ADDED: bool = false;        // to `added`

struct Faces { side: vec4u, rest: vec4u }

fn faces_at(cell: u32) -> Faces {
    return Faces(faces[2u * cell], faces[2u * cell + 1u]);
}

fn light_at(cell: u32) -> mat3x4f {
    let channel = params.count.x * params.count.y * params.count.z;
    return mat3x4f(unpacked(before[cell]), unpacked(before[cell + channel]),
        unpacked(before[cell + 2u * channel]));
}

fn put(cell: u32, gained: mat3x4f) {
    let channel = params.count.x * params.count.y * params.count.z;
    var light = gained;
    if (IS_ADDED) {
        light += mat3x4f(unpacked(added[cell]), unpacked(added[cell + channel]),
            unpacked(added[cell + 2u * channel]));
    }
    after[cell] = packed(light[0]);
    after[cell + channel] = packed(light[1]);
    after[cell + 2u * channel] = packed(light[2]);
}
