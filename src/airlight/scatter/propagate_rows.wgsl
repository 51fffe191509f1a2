// One step, or two at once, over rows that lanes share, marched along z. A layer's rows are read one
// after the other, and what a row's neighbours send it is added before the next one is read: little is
// held at a time. `march` is generated.
//! use layer_hops

// The same numbers for states that are read as they are, some of which may be added to what they send.
fn gained(c: StepCoefficients) -> StepCoefficients {
    var own = c;
    own.even *= c.gain.x;
    own.direct *= c.gain.y;
    own.even.w += params.own;
    own.direct.w += params.own;
    return own;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let slabs = params.slabs;
    let layers = (n.z + slabs - 1u) / slabs;
    let channel = id.z / slabs;
    let at = vec3u(WIDTH * id.x, HEIGHT * id.y, (id.z % slabs) * layers);
    if (channel >= 3u || any(at >= n)) {
        return;
    }
    let c = gained(coefficients[params.row + channel]);
    march(n, c, weights(c), channel * n.x * n.y * n.z, at, min(at.z + layers, n.z));
}
