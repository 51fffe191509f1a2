// One propagation step as Kaplanyan2010 prints it (section 3.3), a cell an invocation, with the bounce of section 7
// (Fig. 8 left). maths.lattice6.hops("paper") is the NumPy twin.
// differs: a hop keeps its power; the paper's weights dOmega/4pi and 1/pi lose a factor 4pi a step.
//! use cell_states

override IS_BLOCKED: bool = true;       // faces block; else all are open
override IS_REFLECTING: bool = false;   // blocked light bounces

const PI = 3.141592653589793;
const FRONT_SR = 0.4006696846;         // solid angle of the neighbour's far face, seen from this cell's centre
const SIDE_SR = 0.4234313544;            // of each of its four side faces
const BOUNCE_LOBE = 2.0;                // |b| / a of a cosine lobe off a blocker

// The power that a state sends through a face: its intensity towards the face's centre, not below zero.
fn face_power(state: vec4f, solid_angle: f32, towards: vec3f) -> f32 {
    return solid_angle * max(0.0, state.x + dot(state.yzw, towards));
}

// A face's power as a cosine lobe along its normal.
fn emitted(power: f32, normal: vec3f) -> vec4f {
    return power * vec4f(1.0 / (4.0 * PI), normal / (2.0 * PI));
}

// Through a side face of the neighbour in direction d.
fn side_gain(state: vec4f, d: vec3f, normal: vec3f) -> vec4f {
    return emitted(face_power(state, SIDE_SR, normalize(d + 0.5 * normal)), normal);
}

// What the neighbour in direction d gains of a state: its five faces but for the shared one.
fn hop(state: vec4f, d: vec3f) -> vec4f {
    let u = d.yzx;
    let v = d.zxy;
    return emitted(face_power(state, FRONT_SR, d), d)
        + side_gain(state, d, u) + side_gain(state, d, -u) + side_gain(state, d, v) + side_gain(state, d, -v);
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

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cell = cell_index(id);
    var leaving = array<u32, 6>();
    var open = array<f32, 6>(1.0, 1.0, 1.0, 1.0, 1.0, 1.0);
    if (IS_BLOCKED) {
        let side = faces[2u * cell];
        let rest = faces[2u * cell + 1u];
        let xy = unpack4x8unorm(rest.z);
        let z = unpack4x8unorm(rest.w);
        leaving = array<u32, 6>(side.x, side.y, side.z, side.w, rest.x, rest.y);
        open = array<f32, 6>(xy.x, xy.y, xy.z, xy.w, z.x, z.y);
    }
    // Hops +x -x +y -y +z -z: each comes from the neighbour that lies against its direction.
    var gained = mat3x4f();
    for (var k = 0u; k < 6u; k++) {
        let is_down = (k & 1u) == 1u;
        var d = vec3f(0.0);
        d[k / 2u] = select(1.0, -1.0, is_down);
        let sent = neighbour(id, k / 2u, is_down);
        for (var c = 0u; c < 3u; c++) {
            gained[c] += met(hop(open[k] * sent[c], d), leaving[k], c, d);
        }
    }
    store_state(cell, gained);
}
