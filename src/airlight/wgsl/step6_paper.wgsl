// One step of a cell as Kaplanyan2010 prints it (section 3.3), with the bounce of section 7 (Fig. 8 left).
// maths.lattice6.hops("paper") is the NumPy twin.
// differs: a hop keeps its power; the paper's weights dOmega/4pi and 1/pi lose a factor 4pi a step.
//! use stencil6

const PI = 3.141592653589793;
const FRONT_SR = 0.4006696846;          // solid angle of the neighbour's far face, seen from this cell's centre
const SIDE_SR = 0.4234313544;           // of each of its four side faces
const SIDE_AHEAD = 0.8944271910;        // cosines of the direction to a side face's centre with the hop
const SIDE_ACROSS = 0.4472135955;       // and with the face's normal

// What the neighbour in direction d gains of a state: through each of its five faces but for the shared one the power
// solid angle times intensity towards the face's centre, not below zero, which goes on as a cosine lobe along the
// face's normal.
fn hop(state: vec4f, d: vec3f) -> vec4f {
    // Axes across the hop, and the state's flux along all three.
    let u = d.yzx;
    let v = d.zxy;
    let along = dot(state.yzw, d);
    let across = vec2f(dot(state.yzw, u), dot(state.yzw, v));
    // Powers through the far face, and through the side faces with normals +u, +v and -u, -v.
    let front = FRONT_SR * max(0.0, state.x + along);
    let ahead = vec2f(state.x + SIDE_AHEAD * along);
    let plus = SIDE_SR * max(vec2f(0.0), ahead + SIDE_ACROSS * across);
    let minus = SIDE_SR * max(vec2f(0.0), ahead - SIDE_ACROSS * across);
    // Their lobes: power P and normal n make (P / 4 pi, P n / 2 pi).
    let power = front + plus.x + plus.y + minus.x + minus.y;
    let net = plus - minus;
    return vec4f(power / (4.0 * PI), (front * d + net.x * u + net.y * v) / (2.0 * PI));
}

// What arrives on a hop meets the blocker one cell further, at the far face, and is reflected into this cell at once,
// as the blocker's lobe.
// differs: what is reflected or absorbed there is taken from what arrived, so that energy does not grow; where
// nothing reflects, it is left to the next step's blocking.
fn met(arrived: vec4f, face: u32, channel: u32, d: vec3f) -> vec4f {
    if (!IS_REFLECTING) {
        return arrived;
    }
    let shares = unpack4x8unorm(face);
    let back = vec4f(1.0, -BOUNCE_LOBE * d);
    return (1.0 - shares.w) * arrived + shares[channel] * arrived.x * back;
}

// What arrives in all channels on a hop in direction d; `far_face` blocks the cell's face ahead.
fn arrived(sent: mat3x4f, d: vec3f, far_face: u32) -> mat3x4f {
    return mat3x4f(met(hop(sent[0], d), far_face, 0u, d), met(hop(sent[1], d), far_face, 1u, d),
        met(hop(sent[2], d), far_face, 2u, d));
}

// The cell's light after the step: what arrives on the six hops.
fn stepped(s: Stencil, faces: Faces) -> mat3x4f {
    var open = s;
    if (IS_BLOCKED) {
        open = entering(s, faces);
    }
    let x = vec3f(1.0, 0.0, 0.0);
    let y = vec3f(0.0, 1.0, 0.0);
    let z = vec3f(0.0, 0.0, 1.0);
    return arrived(open.west, x, faces.side.x) + arrived(open.east, -x, faces.side.y)
        + arrived(open.south, y, faces.side.z) + arrived(open.north, -y, faces.side.w)
        + arrived(open.below, z, faces.rest.x) + arrived(open.above, -z, faces.rest.y);
}
