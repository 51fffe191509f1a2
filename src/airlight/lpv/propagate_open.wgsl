// One step where nothing blocks: channels need not share faces, so each invocation has one.
// `main` comes from lpv/columns.py; a cell's place counts channel after channel.

override IS_ADDED: bool = false;    // to `added`

fn light_at(cell: u32) -> vec4f {
    return unpacked(before[cell]);
}

fn put(cell: u32, gained: vec4f) {
    var light = gained;
    if (IS_ADDED) {
        light += unpacked(added[cell]);
    }
    after[cell] = packed(light);
}

fn gathered(
    cell: u32, here: vec4f, west: vec4f, east: vec4f, south: vec4f, north: vec4f, below: vec4f,
    above: vec4f,
) -> vec4f {
    return along_x(west, east) + along_y(south, north) + along_z(below, above);
}
