// One step in air that varies over tiles of 4 x 2 cells a lane, marched along z, as propagate_walls: what
// a cell's air does to half a hop is worked out once, where it is loaded, and not for each of the 26
// that ask. Beyond the lattice there is no light, and the air goes on as at the border. nx is even.

// What the air does to half a hop of each kind: q what is left; u the share of half its track deposited
// forwards, (L/4) (1 - q - x q)/x^2, w the rest of that half, (L/4) (x - 1 + q)/x^2; as metres, or as
// what scatters there.
struct Air { q: vec3f, u: vec3f, w: vec3f }
struct Cell { v: vec4f, air: Air }

fn air_of(sigma: vec2f) -> Air {
    let lengths = vec3f(LENGTH_0, LENGTH_1, LENGTH_2);
    let quarter = 0.25 * params.cell * lengths;
    let x = 2.0 * sigma.y * quarter;
    let q = exp(-x);
    let is_thin = x < vec3f(0.25);
    let y = select(x, vec3f(1.0), is_thin);
    let r = 1.0 / (y * y);
    let u = select((1.0 - q - y * q) * r, 0.5 - x * (0.33333333 - x * (0.125
        - x * (0.03333333 - x * (0.00694444 - x * 0.00119048)))), is_thin);
    let w = select((y - 1.0 + q) * r, 0.5 - x * (0.16666667 - x * (0.04166667
        - x * (0.00833333 - x * (0.00138889 - x * 0.00019841)))), is_thin);
    let scale = quarter * select(sigma.x, 1.0, IS_TRACK);
    return Air(q, scale * u, scale * w);
}

// A cell, its air as (sigma_s, sigma_t), dark where it is not `is_there`.
fn lit(v: vec4f, bits: u64, is_there: bool) -> Cell {
    let sigma = bitcast<vec2f>(vec2u(u32(bits), u32(bits >> 32u)));
    return Cell(select(vec4f(0.0), v, is_there), air_of(sigma));
}

// What the lanes before and after this one hold.
fn before_this(c: Cell) -> Cell {
    let air = Air(subgroupShuffleUp(c.air.q, 1u), subgroupShuffleUp(c.air.u, 1u),
        subgroupShuffleUp(c.air.w, 1u));
    return Cell(subgroupShuffleUp(c.v, 1u), air);
}

fn after_this(c: Cell) -> Cell {
    let air = Air(subgroupShuffleDown(c.air.q, 1u), subgroupShuffleDown(c.air.u, 1u),
        subgroupShuffleDown(c.air.w, 1u));
    return Cell(subgroupShuffleDown(c.v, 1u), air);
}

// The cell, or one without light in the air of the border beside it.
fn edged(c: Cell, border: Air, is_beyond: bool) -> Cell {
    let air = Air(select(c.air.q, border.q, is_beyond), select(c.air.u, border.u, is_beyond),
        select(c.air.w, border.w, is_beyond));
    return Cell(select(c.v, vec4f(0.0), is_beyond), air);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let slabs = (n.z + SLAB - 1u) / SLAB;
    let channel = id.z / slabs;
    let x = WIDTH * id.x;
    let y = HEIGHT * id.y;
    let z_first = (id.z % slabs) * SLAB;
    if (channel >= 3u || x >= n.x || y >= n.y || z_first >= n.z) {
        return;
    }
    let at = vec2u(x, y);
    let plane = n.x * n.y;
    let first = channel * n.z * plane;
    let z_last = min(z_first + SLAB, n.z);
    var below = layer_at(n, first + (max(z_first, 1u) - 1u) * plane, at, z_first > 0u);
    var here = layer_at(n, first + z_first * plane, at, true);
    var z = z_first;
    loop {
        let above = layer_at(n, first + min(z + 1u, n.z - 1u) * plane, at, z + 1u < n.z);
        let cell = z * plane + y * n.x + x;
        store(n, first + cell, at, stepped(n, below, here, above, channel, cell));
        below = here;
        here = above;
        z++;
        if (z >= z_last) {
            break;
        }
    }
}
