// Lattices whose colour channels lie one after the other, [channel][z][y][x], and kernels over all their cells.
//! use cell_order

// Where a cell's value is.
fn index_in(count: vec3u, at: vec3u, channel: u32) -> u32 {
    return cell_in(count, vec3u(at.xy, channel * count.z + at.z));
}

struct ChannelCell {
    at: vec3u,
    channel: u32,
    is_there: bool,     // else the invocation lies beyond them
}

// Of an invocation, where there are count.x by count.y by 3 count.z or more.
fn channel_cell(count: vec3u, id: vec3u) -> ChannelCell {
    let channel = id.z / count.z;
    return ChannelCell(vec3u(id.xy, id.z % count.z), channel, id.x < count.x && id.y < count.y && channel < 3u);
}
