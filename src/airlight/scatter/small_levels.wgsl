// Cycles of small lattices, a channel per workgroup: runs of steps, and after each what takes light
// to a coarser lattice, or back. Loops test at their end, where CPU adapters leave them sooner.

const CLOSED = 0.05;

var<workgroup> partial: array<vec2f, WX>;

fn cells_of(n: vec3u) -> u32 {
    return n.x * n.y * n.z;
}

fn place_of(n: vec3u, cell: u32) -> vec3u {
    return vec3u(cell % n.x, (cell / n.x) % n.y, cell / (n.x * n.y));
}

fn part(first: vec3u, k: u32) -> vec3u {
    return first + vec3u(k & 1u, (k >> 1u) & 1u, k >> 2u);
}

fn cell_at(n: vec3u, at: vec3u) -> u32 {
    return (at.z * n.y + at.y) * n.x + at.x;
}

fn run_step(s: SmallStep, channel: u32, thread: u32) {
    let cells = cells_of(s.count);
    let c = coefficients[s.row + channel];
    let first = channel * cells;
    var cell = thread;
    loop {
        if (cell < cells) {
            states[s.after + first + cell] = states[s.source + first + cell]
                + stepped(c, s, place_of(s.count, cell), channel, cell);
        }
        cell += WX;
        if (cell >= cells) { break; }
    }
}

// As level_restrict.
fn restrict_residual(s: SmallStage, channel: u32, thread: u32) {
    let fine = channel * cells_of(s.fine);
    let cells = select(0u, cells_of(s.coarse), s.kind == 1u);
    for (var cell = thread; cell < cells; cell += WX) {
        let first = 2u * place_of(s.coarse, cell);
        var total = vec4f(0.0);
        for (var k = 0u; k < 8u; k++) {
            let p = part(first, k);
            if (all(p < s.fine)) {
                let i = fine + cell_at(s.fine, p);
                total += states[s.given + i] - states[s.current + i];
            }
        }
        states[s.made + channel * cells + cell] = total;
    }
}

// As level_prolong.
fn prolonged_share(s: SmallStage, at: vec3u, channel: u32) -> f32 {
    let fine = s.current + channel * cells_of(s.fine);
    let first = 2u * (at / 2u);
    var open = 1.0;
    var total = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let p = part(first, k);
        if (all(p < s.fine)) {
            let cell = cell_at(s.fine, p);
            let side = p - first;
            let packed = face_visibility[s.cell + cell];
            let xy = unpack4x8unorm(packed.x);
            let z = unpack4x8unorm(packed.y);
            let entered = vec3f(select(xy.y, xy.x, side.x == 1u),
                select(xy.w, xy.z, side.y == 1u), select(z.y, z.x, side.z == 1u));
            open = min(open, min(entered.x, min(entered.y, entered.z)));
            total += max(0.0, states[fine + cell].x);
        }
    }
    let own = max(0.0, states[fine + cell_at(s.fine, at)].x);
    let held = select(0.0, 8.0 * own / total, total > 0.0);
    return select(1.0, held, open < 1.0 - CLOSED);
}

fn prolong(s: SmallStage, channel: u32, thread: u32) {
    let cells = select(0u, cells_of(s.fine), s.kind == 2u);
    let coarse = s.given + channel * cells_of(s.coarse);
    let level = levels[s.level];
    for (var cell = thread; cell < cells; cell += WX) {
        let at = place_of(s.fine, cell);
        var share = 0.125 / level.way[channel];
        if (level.has_walls > 0.0) {
            share *= prolonged_share(s, at, channel);
        }
        let found = states[coarse + cell_at(s.coarse, at / 2u)];
        states[s.made + channel * cells + cell] = share
            * vec4f(found.x, 3.0 / (RHO * RHO) * found.yzw);
    }
}

// As level_search: this invocation's part of r.d and d.d.
fn searched(s: SmallStage, channel: u32, thread: u32) -> vec2f {
    let fine = channel * cells_of(s.fine);
    let cells = select(0u, cells_of(s.coarse), s.kind == 3u);
    var found = vec2f(0.0);
    for (var cell = thread; cell < cells; cell += WX) {
        let first = 2u * place_of(s.coarse, cell);
        var lacking = vec4f(0.0);
        var taken = vec4f(0.0);
        for (var k = 0u; k < 8u; k++) {
            let p = part(first, k);
            if (all(p < s.fine)) {
                let i = fine + cell_at(s.fine, p);
                lacking += states[s.given + i] - states[s.current + i];
                taken += states[s.change + i] - states[s.answer + i];
            }
        }
        found += vec2f(dot(lacking, taken), dot(taken, taken));
    }
    return found;
}

// As level_length and level_correct.
fn correct(s: SmallStage, channel: u32, thread: u32) {
    let found = partial[0];
    let along = clamp(MOST * select(0.0, found.x / found.y, found.y > 0.0), 0.0, 1.0);
    let cells = select(0u, cells_of(s.fine), s.kind == 3u);
    let first = channel * cells;
    for (var cell = thread; cell < cells; cell += WX) {
        let i = first + cell;
        states[s.made + i] = states[s.given + i] + along * states[s.answer + i];
    }
}

@compute @workgroup_size(WX, WY, WZ)
fn main(@builtin(local_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    let channel = group.y;
    let count = arrayLength(&stages);
    var k = 0u;
    loop {
        let s = stages[k];
        var step = s.first;
        loop {
            run_step(steps[step], channel, id.x);
            storageBarrier();
            step += 1u;
            if (step >= s.end) { break; }
        }
        restrict_residual(s, channel, id.x);
        prolong(s, channel, id.x);
        partial[id.x] = searched(s, channel, id.x);
        workgroupBarrier();
        for (var half = WX / 2u; half > 0u; half /= 2u) {
            if (id.x < half) {
                partial[id.x] += partial[id.x + half];
            }
            workgroupBarrier();
        }
        correct(s, channel, id.x);
        storageBarrier();
        k += 1u;
        if (k >= count) { break; }
    }
}
