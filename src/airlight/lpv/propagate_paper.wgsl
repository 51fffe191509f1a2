// The paper's bounce (section 7, Fig. 8 left): what arrives on a hop meets the blocker one cell
// further, at the far face, and is reflected into this cell at once, as the blocker's lobe.
// differs: what is reflected or absorbed there is taken from what arrived, so that energy does not
// grow; where nothing reflects, it is left to the next step's blocking.
fn met(arrived: vec4f, face: u32, channel: u32, direction: vec3f) -> vec4f {
    let shares = unpack4x8unorm(face);
    if (!IS_REFLECTING) {
        return arrived;
    }
    let back = vec4f(1.0, -BOUNCE_LOBE * direction);
    return (1.0 - shares.w) * arrived + shares[channel] * arrived.x * back;
}

fn channel_met(
    c: u32, side: vec4u, rest: vec4u, west: vec4f, east: vec4f, south: vec4f, north: vec4f,
    below: vec4f, above: vec4f,
) -> vec4f {
    let x = vec3f(1.0, 0.0, 0.0);
    let y = vec3f(0.0, 1.0, 0.0);
    let z = vec3f(0.0, 0.0, 1.0);
    return met(hop_0(west), side.x, c, x) + met(hop_1(east), side.y, c, -x)
        + met(hop_2(south), side.z, c, y) + met(hop_3(north), side.w, c, -y)
        + met(hop_4(below), rest.x, c, z) + met(hop_5(above), rest.y, c, -z);
}

fn interacted(
    here: mat3x4f, side: vec4u, rest: vec4u, west: mat3x4f, east: mat3x4f, south: mat3x4f,
    north: mat3x4f, below: mat3x4f, above: mat3x4f,
) -> mat3x4f {
    return mat3x4f(
        channel_met(0u, side, rest, west[0], east[0], south[0], north[0], below[0], above[0]),
        channel_met(1u, side, rest, west[1], east[1], south[1], north[1], below[1], above[1]),
        channel_met(2u, side, rest, west[2], east[2], south[2], north[2], below[2], above[2]));
}
