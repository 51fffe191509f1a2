// A cell's light in one channel; its place counts channel after channel.

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
