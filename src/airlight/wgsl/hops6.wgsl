// What a cell receives of its six neighbours in one propagation step (Kaplanyan2010 section 3.3), for light that
// keeps the mean direction of the faces it goes through. A state is (a, b), two-band intensity, W sr^-1.
// The constants are entries of the matrix of the hop along +x: maths.lattice6.hops is the NumPy twin.

override MEAN_TO_MEAN: f32;     // gained a of a: the share of the neighbour's power, 1/6
override FLUX_TO_MEAN: f32;     // gained a of b along the hop
override MEAN_TO_FLUX: f32;     // gained b along the hop of a
override FLUX_ALONG: f32;       // gained b along the hop of b along it
override FLUX_ACROSS: f32;      // gained b across the hop of b across it

// Opposite hops differ in the sign of what couples a with b along the axis. `up` comes from the neighbour on the
// low side and travels up the axis, `down` from the high side.
fn received_x(up: vec4f, down: vec4f) -> vec4f {
    let odd = up - down;
    return (up + down) * vec4f(MEAN_TO_MEAN, FLUX_ALONG, FLUX_ACROSS, FLUX_ACROSS)
        + vec4f(odd.y * FLUX_TO_MEAN, odd.x * MEAN_TO_FLUX, 0.0, 0.0);
}

fn received_y(up: vec4f, down: vec4f) -> vec4f {
    let odd = up - down;
    return (up + down) * vec4f(MEAN_TO_MEAN, FLUX_ACROSS, FLUX_ALONG, FLUX_ACROSS)
        + vec4f(odd.z * FLUX_TO_MEAN, 0.0, odd.x * MEAN_TO_FLUX, 0.0);
}

fn received_z(up: vec4f, down: vec4f) -> vec4f {
    let odd = up - down;
    return (up + down) * vec4f(MEAN_TO_MEAN, FLUX_ACROSS, FLUX_ACROSS, FLUX_ALONG)
        + vec4f(odd.w * FLUX_TO_MEAN, 0.0, 0.0, odd.x * MEAN_TO_FLUX);
}

// The same of one neighbour on hop 0..5 (+x -x +y -y +z -z).
fn received(state: vec4f, hop: u32) -> vec4f {
    let is_down = (hop & 1u) == 1u;
    let up = select(state, vec4f(0.0), is_down);
    let down = select(vec4f(0.0), state, is_down);
    switch hop / 2u {
        case 0u: { return received_x(up, down); }
        case 1u: { return received_y(up, down); }
        default: { return received_z(up, down); }
    }
}
