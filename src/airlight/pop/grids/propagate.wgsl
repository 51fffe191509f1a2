// A step of light through the grids of all ordinates (Elek2014 sections 4.1 to 4.3): a cell takes
// what its six neighbours send, absorbs and scatters it, and sends the rest on; see
// maths/ordinate_hops.py.
//! use hop_light

const SHARE = 0.6;                  // of scattering, what joins the residuum; the rest widens lobes
const SHARE_RADIAL = 0.5;           // the same in radial grids
const SHARE_RADIAL_PEAKED = 0.25;   // the same in radial grids from a g of PEAKED on
const PEAKED = 0.8;
const HAND_OVER_HIGH = 0.65;        // lobes of this mean cosine begin to join the residuum,
const HAND_OVER_LOW = 0.45;         // and of this one all do
const CARRIED = 0.15;               // of a lobe that joins the residuum, what stays net power

// Power that arrives in a cell, W, and the same times the mean cosine of its lobe.
struct Arrival {
    power: vec3f,
    along: vec3f,
}

// What a cell sent in the last step.
fn sent(n: u32, cell: vec3u) -> Outflow {
    let slot = hop_slot(n, hop_index(n, cell));
    let x = states_in[slot];
    let y = states_in[slot + 1u];
    let z = states_in[slot + 2u];
    return Outflow(x.xyz, y.xyz, z.xyz, vec3f(x.w, y.w, z.w));
}

fn take(sum: ptr<function, Arrival>, power: vec3f, a: vec3f) {
    (*sum).power += power;
    (*sum).along += power * a;
}

// The light that the six neighbours send to a cell; `gate`: visibility between it and the one
// before.
fn arriving(n: u32, cell: vec3u, gate: f32) -> Arrival {
    var sum = Arrival(vec3f(0.0), vec3f(0.0));
    let count = grids[n].count;
    let is_radial = grids[n].is_radial == 1u;
    // From the cells before and behind it along the light.
    if (cell.z > 0u) {
        let o = sent(n, cell - vec3u(0u, 0u, 1u));
        take(&sum, gate * o.ahead, o.a);
    }
    if (cell.z + 1u < count.z) {
        let o = sent(n, cell + vec3u(0u, 0u, 1u));
        take(&sum, o.behind, o.a);
    }
    // From the four beside it. Shells keep what their smaller neighbours cannot take.
    var stays = 0.0;
    for (var side = 0u; side < 4u; side++) {
        let other = hop_beside(n, cell, side);
        if (other.z != 0xffffffffu) {
            let o = sent(n, other);
            take(&sum, hop_side_gain(n, other, cell) * o.side, o.a);
            stays += 1.0 - hop_side_gain(n, cell, other);
        }
    }
    if (is_radial) {
        let own = sent(n, cell);
        take(&sum, stays * own.side + select(vec3f(0.0), own.behind, cell.z == 0u), own.a);
    }
    return sum;
}

struct Scattered {
    leaving: vec3f,  // share that joins the residuum
    a: vec3f,        // the rest's
}

// Scattering in a cell of density `rho`, of a lobe of mean cosine `a`.
fn scattered(n: u32, cell: vec3u, rho: f32, a: vec3f) -> Scattered {
    let path = hop_path(n, cell.z);
    let depth = rho * params.sigma_t * params.albedo * path;
    // As printed, the lobe alone widens.
    if (hops.is_paper == 1u) {
        let g = max(params.g, vec3f(0.0));
        let widened = select(vec3f(0.0), pow(max(g, vec3f(1e-9)), depth), g > vec3f(0.0));
        return Scattered(vec3f(0.0), a * select(vec3f(1.0), widened, depth > vec3f(0.0)));
    }
    // Else a share of the scattering, reduced by g, joins the residuum; the rest widens the lobe.
    let lost = depth * (1.0 - params.g);
    if (grids[n].is_radial == 1u) {
        let peaked = params.g >= vec3f(PEAKED);
        let share = select(vec3f(SHARE_RADIAL), vec3f(SHARE_RADIAL_PEAKED), peaked);
        let narrowing = path / max(shell_radius(n, cell.z), path);
        let after = a * exp(-(1.0 - share) * lost) + 2.0 / 3.0 * (1.0 - a * a) * narrowing;
        return Scattered(1.0 - exp(-share * lost), clamp(after, vec3f(0.0), vec3f(LARGEST_A)));
    }
    let after = a * exp(-(1.0 - SHARE) * lost);
    let handed = saturate((HAND_OVER_HIGH - after) / (HAND_OVER_HIGH - HAND_OVER_LOW));
    return Scattered(1.0 - exp(-SHARE * lost) * (1.0 - handed), after);
}

// One cell of grid n.
fn step_cell(n: u32, index: u32) {
    let cell = hop_cell(n, index);
    let slot = hop_slot(n, index);
    let density = hop_rho[n * hops.capacity + index];
    let rho = max(density, 0.0);
    let gate = gathered[slot].w;
    // Light that arrives, and its lobe.
    let sum = arriving(n, cell, gate);
    let some = sum.power > vec3f(1e-30);
    var a = select(vec3f(0.0), sum.along / select(vec3f(1.0), sum.power, some), some);
    // A box is convex: light that has left it does not come back, as it would from cell to cell.
    let is_lost = density < 0.0 && hops.is_paper == 0u;
    // What absorption leaves of it, and scattering of that.
    let absorption = rho * params.sigma_t * (1.0 - params.albedo);
    let power = select(1.0, 0.0, is_lost) * sum.power
        * exp(-absorption * hop_path(n, cell.z) * straight_path(n, a));
    let gone = scattered(n, cell, rho, a);
    a = gone.a;
    let left = power * (1.0 - gone.leaving);
    // What the eye sees of it, what joins the residuum, and what is sent on.
    if (rho > 0.0) {
        gathered[slot] += vec4f(seen_light(n, cell, rho, left, a, straight_path(n, a)), 0.0);
    }
    let handed = select(power * gone.leaving, power, hops.is_last == 1u);
    let carried = select(CARRIED, 0.0, hops.is_paper == 1u || grids[n].is_radial == 1u);
    gathered[slot + 1u] += vec4f(handed, 0.0);
    gathered[slot + 2u] += vec4f(carried * handed * a, 0.0);
    send_out(slot, left, a, gate);
}

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u,
) {
    // Where there are more cells than invocations, each goes through several.
    let count = listed[0];
    var k = id.x;
    if (k >= count) {
        return;
    }
    loop {
        let entry = listed[1u + k];
        step_cell(entry / hops.capacity, entry % hops.capacity);
        k += WX * groups.x;
        if (k >= count) {
            break;
        }
    }
}
