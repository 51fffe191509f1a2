// What lattices scatter towards the eye. The including pass binds what `lattice` needs and the
// table `lattices`, the finest first, and adds LATTICES_AT_ONCE, how many fade into each other at one
// place, and what samples their textures (march/march.py). Loops are tested at their ends: software
// drivers run a body once more than a test before it lets through.
//! use air
//! use lattice

// Texture coordinates of the step's middle, and their weight; the first is 0 where there are none.
var<private> lattice_at: array<vec4f, LATTICES_AT_ONCE>;
// A cell's power over that of the largest lattice, where both hold the same light.
var<private> lattice_gain: array<f32, LATTICES_AT_ONCE>;

// The only lattice, copied: a software driver reads a buffer lane by lane.
var<private> lattice_alone: LatticeParams;

fn lattice_begin() {
    if (LATTICES_AT_ONCE == 1u) {
        lattice_alone = lattices[arrayLength(&lattices) - 1u];
    }
}

// lattice_eased(bent_place(p)) of the only lattice, from its packed cells (march/march_cells.py).
fn cell_index(cell: vec3i) -> u32 {
    let at = vec3u(cell);
    return (at.z * lattice_alone.count.y + at.y) * lattice_alone.count.x + at.x;
}

fn eased_alone(p: vec3f) -> vec3f {
    let place = (p - lattice_alone.origin) / lattice_alone.cell;
    let last = vec3i(lattice_alone.count) - 1;
    let cell = clamp(vec3i(floor(place)), vec3i(0), last);
    let walls = march_cells[cell_index(cell)].zw;
    let low = unpack4x8snorm(walls.x);
    let high = unpack4x8snorm(walls.y);
    let bent = vec3f(bent_axis(place.x, cell.x, low.x, high.x),
        bent_axis(place.y, cell.y, low.y, high.y), bent_axis(place.z, cell.z, low.z, high.z));
    let there = clamp(vec3i(floor(bent)), vec3i(0), last);
    let faces = march_cells[cell_index(there)].xy;
    let xy = unpack4x8unorm(faces.x);
    let z = unpack4x8unorm(faces.y);
    let t = clamp(bent - vec3f(there), vec3f(0.0), vec3f(1.0)) - 0.5;
    let eased = vec3f(open_fraction(t.x, xy.x, xy.y, 0.0), open_fraction(t.y, xy.z, xy.w, 0.0),
        open_fraction(t.z, z.x, z.y, 0.0));
    return lattice_uvw(lattice_alone, vec3f(there) + 0.5 + eased);
}

fn lattice_enter(p: vec3f) {
    if (LATTICES_AT_ONCE == 1u) {
        let uvw = eased_alone(p);
        lattice_at[0] = vec4f(uvw, lattice_weight(lattice_alone, p));
        lattice_gain[0] = 1.0;
        return;
    }
    let last = arrayLength(&lattices) - 1u;
    for (var i = 0u; i < LATTICES_AT_ONCE; i++) {
        lattice_at[i].w = 0.0;
    }
    var left = 1.0;
    var found = 0u;
    var k = 0u;
    loop {
        let weight = left * lattice_weight(lattices[k], p);
        if (weight > 0.0) {
            let finer = lattices[last].cell / lattices[k].cell;
            let uvw = lattice_coordinates(lattices[k], p, vec3f(0.0));
            lattice_at[found] = vec4f(uvw, weight);
            lattice_gain[found] = finer * finer;
            left -= weight;
            found++;
        }
        k++;
        if (k > last || left <= 0.0 || found >= LATTICES_AT_ONCE) {
            break;
        }
    }
}

// `is_power`: the texture holds the power of cells, not what is per square metre.
fn lattice_blended(states: texture_3d<f32>, is_power: bool) -> vec4f {
    if (LATTICES_AT_ONCE == 1u) {
        return lattice_at[0].w * textureSampleLevel(states, linear_clamp, lattice_at[0].xyz, 0.0);
    }
    var sum = vec4f(0.0);
    var i = 0u;
    loop {
        let gain = lattice_at[i].w * select(1.0, lattice_gain[i], is_power);
        sum += gain * textureSampleLevel(states, linear_clamp, lattice_at[i].xyz, 0.0);
        i++;
        if (i >= LATTICES_AT_ONCE || lattice_at[min(i, LATTICES_AT_ONCE - 1u)].w <= 0.0) {
            break;
        }
    }
    return sum;
}

// Cells of the finest lattice that has the place, over the finest lattice's.
fn march_step_share(p: vec3f) -> f32 {
    if (LATTICES_AT_ONCE == 1u) {
        return 1.0;
    }
    let last = arrayLength(&lattices) - 1u;
    var k = 0u;
    while (k < last && lattice_weight(lattices[k], p) <= 0.0) {
        k++;
    }
    return lattices[k].cell / lattices[0].cell;
}

fn lattice_radiance(state: vec4f, travel: vec3f, direct: f32) -> f32 {
    return max(0.0, state.x + direct * dot(state.yzw, travel));
}
