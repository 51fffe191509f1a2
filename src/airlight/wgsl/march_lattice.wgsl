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

fn lattice_enter(p: vec3f) {
    if (LATTICES_AT_ONCE == 1u) {
        let uvw = lattice_eased(lattice_alone, bent_place(lattice_alone, p), vec3f(0.0));
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
