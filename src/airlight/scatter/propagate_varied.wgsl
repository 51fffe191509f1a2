// One step in air that varies, a cell and channel per invocation. Beyond the lattice there is no
// light, and the air goes on as at the border.

struct Cell {
    v: vec4f,   // state; 0 beyond the lattice
    s: f32,     // sigma_s, m^-1
    t: f32,     // sigma_t, m^-1
}

fn cell_at(at: vec3i, channel: u32) -> Cell {
    let n = params.count;
    let p = vec3u(clamp(at, vec3i(0), vec3i(n) - 1));
    let index = ((channel * n.z + p.z) * n.y + p.y) * n.x + p.x;
    let air = medium[index];
    return Cell(select(vec4f(0.0), before[index], all(vec3i(p) == at)), air.x, air.y);
}

// Half a hop of `cells` cells through extinction sigma_t, metres per unit of power:
// q what is left; u the share of half its track deposited forwards, (L/4) (1 - q - x q)/x^2,
// w the rest of that half, (L/4) (x - 1 + q)/x^2.
fn half_hop(sigma_t: f32, cells: f32) -> vec3f {
    let quarter = 0.25 * cells * params.cell;
    let x = 2.0 * quarter * sigma_t;
    let q = exp(-x);
    let is_thin = x < 0.25;
    let y = select(x, 1.0, is_thin);
    let forwards = select((1.0 - q - y * q) / (y * y), 0.5 - x * (0.33333333 - x * (0.125
        - x * (0.03333333 - x * (0.00694444 - x * 0.00119048)))), is_thin);
    let back = select((y - 1.0 + q) / (y * y), 0.5 - x * (0.16666667 - x * (0.04166667
        - x * (0.00833333 - x * (0.00138889 - x * 0.00019841)))), is_thin);
    return vec3f(q, quarter * forwards, quarter * back);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.count;
    let channel = id.z / n.z;
    if (id.x >= n.x || id.y >= n.y || channel >= 3u) {
        return;
    }
    let at = vec3u(id.xy, id.z % n.z);
    let cell = (at.z * n.y + at.y) * n.x + at.x;
    let own = cell_at(vec3i(at), channel);
    let index = channel * n.x * n.y * n.z + cell;
    after[index] = source[index] + gathered(own, vec3i(at), channel, 4u * cell);
}
