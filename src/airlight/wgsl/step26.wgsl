// What a cell gets, in one iteration, from its exchange with one of its 26 neighbours (Billeter2012
// eq. 3). Light crosses half of a hop in either cell; what it loses there is scattered, and shared
// between the two by where it is lost. Walls between the cells stop light and reflect it.
// NumPy twins: maths.lattice26.half_linear_step and deposit_step, maths.lattice26_walls.bounced.
// differs: Billeter2012 has homogeneous media, deposits in the cell that light enters alone, and
// drops what walls stop.
//! use hops26
//! needs fn cell_beside(at: vec3i, channel: u32, step: vec3i) -> Cell

override IS_VARIED = false;     // the medium differs from cell to cell
override HAS_WALLS = false;
override HANDED_ON = 0.0;       // as printed, above 0: share of what scatters that eq. 3 hands on

// A cell's state, and what its half of a hop does to 1 W, by kind of hop: q is transmitted; of what is
// lost u is ahead of the middle, w is the rest. Both are halved, times the hop's weight: as W that
// scatter, or as W m of track. Of the net direction q times `ahead` is transmitted. In a homogeneous
// medium StepCoefficients know it all.
struct Cell { state: vec4f, q: vec3f, u: vec3f, w: vec3f, ahead: f32 }

// Shares that walls leave open of hops by their number, the faces' as vectors, and a reflectance.
struct Walls {
    entering: array<vec4f, 7>,
    leaving: array<vec4f, 7>,
    closed_low: vec3f,          // how closed the faces towards -x, -y, -z are
    closed_high: vec3f,
    reflectance: f32,
}

// What eq. 3 leaves of a state in the `medium` of its cell; tracks are whole hops'.
// Twin: scatter.coefficients.paper_gain.
fn paper_gain(medium: vec2f) -> vec4f {
    let distance = MEAN_HOP * params.cell;
    let passed = 1.0 - distance * medium.y;
    let gain = vec4f(passed + HANDED_ON * distance * medium.x, vec3f(passed));
    return select(gain, vec4f(1.0), params.is_track != 0u);
}

fn homogeneous_cell(state: vec4f) -> Cell {
    return Cell(state, vec3f(1.0), vec3f(0.0), vec3f(0.0), 1.0);
}

// What half a hop transmits more of the net direction than of the power, for a `medium` of sigma_s and
// sigma_t, m^-1: two bands damp it too soon where media absorb. Twin: maths.lattice26.flux_gain.
fn flux_gain(medium: vec2f) -> f32 {
    let c = saturate(medium.x / max(medium.y, 1e-30));
    let share = (1.0 + 2.0 * c) / 3.0 + c * (1.0 - c) * (0.25508 * c - 0.35534);
    let depth = 0.5 * MEAN_HOP * params.cell * medium.y;
    return min(exp((1.0 - share) * depth), max(1.0, inverseSqrt(params.straight * RHO)));
}

// `medium`: sigma_s and sigma_t, m^-1. With x the optical depth of half a hop of length L, q = exp(-x),
// u = (L/4) (1 - q - x q)/x^2, w = (L/4) (x - 1 + q)/x^2; series where x is small.
fn varied_cell(state: vec4f, medium: vec2f) -> Cell {
    if (HANDED_ON > 0.0) {
        return homogeneous_cell(state * paper_gain(medium));
    }
    // For hops across faces, edges and corners at once.
    let quarter = 0.25 * params.cell * HOP_LENGTHS;
    let x = 2.0 * medium.y * quarter;
    let q = exp(-x);
    let is_thin = x < vec3f(0.25);
    let y = select(x, vec3f(1.0), is_thin);
    let r = 1.0 / (y * y);
    let u = select((1.0 - q - y * q) * r, 0.5 - x * (0.33333333 - x * (0.125
        - x * (0.03333333 - x * (0.00694444 - x * 0.00119048)))), is_thin);
    let w = select((y - 1.0 + q) * r, 0.5 - x * (0.16666667 - x * (0.04166667
        - x * (0.00833333 - x * (0.00138889 - x * 0.00019841)))), is_thin);
    let scale = quarter * select(medium.x, 1.0, params.is_track != 0u) * HOP_WEIGHTS;
    return Cell(state, q, scale * u, scale * w, flux_gain(medium));
}

// What a cell's own half of hops does, as the table has it for whole hops of a homogeneous medium.
fn varied_coefficients(own: Cell) -> StepCoefficients {
    let is_track = params.is_track != 0u;
    let passed = select(own.q * HOP_WEIGHTS, vec3f(0.0), is_track);
    var c: StepCoefficients;
    c.arriving = 2.0 * own.u + own.w + passed;
    c.passing = 3.0 * params.straight * own.ahead / HOP_LENGTHS * passed;
    c.kept = own.u + 2.0 * own.w;
    c.stopped = 2.0 * (own.u + own.w);
    c.returned = own.q * (c.stopped + passed);
    c.turned = own.q * select(RETURNED * passed, REFLECTED_TRACK * c.stopped, is_track);
    return c;
}

fn no_walls() -> Walls {
    let open = array<vec4f, 7>(vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0), vec4f(1.0),
        vec4f(1.0));
    return Walls(open, open, vec3f(0.0), vec3f(0.0), 0.0);
}

fn seven(a: vec4u, b: vec4u) -> array<vec4f, 7> {
    return array<vec4f, 7>(unpack4x8unorm(a.x), unpack4x8unorm(a.y), unpack4x8unorm(a.z),
        unpack4x8unorm(a.w), unpack4x8unorm(b.x), unpack4x8unorm(b.y), unpack4x8unorm(b.z));
}

// Of packs as scatter.hop_visibility makes them: two of hops that enter the cell, two that leave it.
fn unpacked_walls(packs: array<vec4u, 4>, channel: u32) -> Walls {
    let leaving = seven(packs[2], packs[3]);
    // Hops 12, 10, 4 and 14, 16, 22 cross the faces.
    let low = 1.0 + SPLIT_FLOOR - vec3f(leaving[3].x, leaving[2].z, leaving[1].x);
    let high = 1.0 + SPLIT_FLOOR - vec3f(leaving[3].z, leaving[4].x, leaving[5].z);
    return Walls(seven(packs[0], packs[1]), leaving, low, high, unpack4x8unorm(packs[3].w)[channel]);
}

// Power, per weight of the hop, that a state sends along an offset; of any sign.
fn sent_power(state: vec4f, offset: vec3f, kind: u32) -> f32 {
    return state.x + RHO / HOP_LENGTHS[kind] * dot(state.yzw, offset);
}

// Adds to `sum`, (A, B): what arrives from the neighbour at `step`, and what stays of what the
// cell sends there.
fn exchange(sum: ptr<function, vec4f>, c: StepCoefficients, own: Cell, far: Cell,
        walls: ptr<function, Walls>, step: vec3i) {
    let j = hop_number(step);
    let k = hop_kind(step);
    let offset = vec3f(step);
    // The neighbour's light comes against the offset: what passes both halves, and what they scatter.
    let came = sent_power(far.state, -offset, k) * (*walls).entering[j / 4u][j & 3u];
    let arriving = came * (far.u[k] + far.q[k] * c.arriving[k]);
    let passing = came * far.q[k] * far.ahead * c.passing[k];
    // What the cell sends through the open share, and what of it is scattered behind the middle.
    let sent = sent_power(own.state, offset, k);
    let open = sent * (*walls).leaving[j / 4u][j & 3u];
    let kept = open * (c.kept[k] + own.q[k] * far.w[k]);
    // What a wall stops is scattered on the way to it.
    let shut = sent - open;
    let stopped = shut * c.stopped[k];
    // Track keeps its direction; scattered light has none, and what passed keeps some of its own.
    let along = select(0.0, RHO / HOP_LENGTHS[k], params.is_track != 0u);
    *sum += vec4f(arriving + kept + stopped, (along * (kept + stopped - arriving) - passing) * offset);
    if (HAS_WALLS) {
        // Reflected light leaves along the mean normal of the walls that closed the hop, by how closed
        // they are. A wall gives back negative power whole, or absorbing it would add light.
        let white = (*walls).reflectance;
        let back = shut * select(white, 1.0, sent < 0.0);
        let closed = select((*walls).closed_high, (*walls).closed_low, step < vec3i(0));
        let walled = offset * select(closed, vec3f(1.0), k == 0u);
        let turned = back * c.turned[k] / dot(offset, walled);
        *sum += vec4f(back * c.returned[k], -turned * walled);
    }
}

// A cell, where it is, and what its medium does to whole hops.
struct Here { at: vec3i, channel: u32, own: Cell, c: StepCoefficients }

fn visit(sum: ptr<function, vec4f>, here: Here, walls: ptr<function, Walls>, step: vec3i) {
    exchange(sum, here.c, here.own, cell_beside(here.at, here.channel, step), walls, step);
}

fn visit_row(sum: ptr<function, vec4f>, here: Here, walls: ptr<function, Walls>, y: i32, z: i32) {
    visit(sum, here, walls, vec3i(-1, y, z));
    if (y != 0 || z != 0) {
        visit(sum, here, walls, vec3i(0, y, z));
    }
    visit(sum, here, walls, vec3i(1, y, z));
}

fn visit_layer(sum: ptr<function, vec4f>, here: Here, walls: ptr<function, Walls>, z: i32) {
    visit_row(sum, here, walls, -1, z);
    visit_row(sum, here, walls, 0, z);
    visit_row(sum, here, walls, 1, z);
}

// K before in one cell. Calls in place of loops: drivers that unroll none would look up every number.
fn exchanged(here: Here, walls: ptr<function, Walls>) -> vec4f {
    var sum = vec4f(0.0);
    visit_layer(&sum, here, walls, -1);
    visit_layer(&sum, here, walls, 0);
    visit_layer(&sum, here, walls, 1);
    return sum;
}
