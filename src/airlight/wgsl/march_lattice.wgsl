// What lattices scatter towards the eye. The including pass binds what `lattice` needs and the
// table `lattices`, the finest first, and adds LATTICES_AT_ONCE, how many fade into each other at one
// place, and what samples their textures (media/march/march.py). Loops are tested at their ends: CPU
// adapters run a body once more than a test before it passes.
//! use lattice
//! use obliqueness

// Texture coordinates of the step's middle, and their weight; the first is 0 where there are none.
var<private> lattice_at: array<vec4f, LATTICES_AT_ONCE>;
// A cell's power over that of the largest lattice, where both hold the same light.
var<private> lattice_gain: array<f32, LATTICES_AT_ONCE>;

// The only lattice, copied: a CPU adapter reads a buffer lane by lane. Divisions are made once.
struct LatticeAlone {
    origin: vec3f,          // m, along its axes
    per_metre: f32,         // cells
    count: vec3f,
    last: vec3f,            // its last cell
    first: vec3f,           // cells before it in the textures
    per_texel: vec3f,       // texture coordinates
    rise: vec3f,            // of its weight, m^-1, from fade_low
    risen: vec3f,           // at the world's origin
    fall: vec3f,            // m^-1, to fade_high
    fallen: vec3f,
}
var<private> alone: LatticeAlone;
// Rows are the axes that all lattices have.
var<private> lattice_axes: mat3x3f;

fn lattice_begin() {
    let lattice = first_lattices();
    lattice_axes = transpose(mat3x3f(lattice.axis_x, lattice.axis_y, lattice.axis_z));
    if (LATTICES_AT_ONCE > 1u) {
        return;
    }
    let count = vec3f(lattice.count);
    let rise = 1.0 / lattice.fade_low_width;
    let fall = 1.0 / lattice.fade_high_width;
    alone = LatticeAlone(lattice.origin, 1.0 / lattice.cell, count, count - 1.0,
        vec3f(0.0, f32(lattice.first_row), 0.0),
        1.0 / vec3f(textureDimensions(lattice_red)),
        rise, -lattice.fade_low * rise, fall, lattice.fade_high * fall);
}

// From where on fog is read before an oblique plane: cosines of 25 and 15 degrees. Light is read farther before it
// than surfaces are looked up, which planes closer to an axis need not.
const OBLIQUE_TO_FOG = vec2f(0.9, 0.97);

// How oblique a surface of normal n, of the world, is to the cells, 0 to 1.
fn lattice_obliqueness(n: vec3f) -> f32 {
    return obliqueness(lattice_axes * n, OBLIQUE_TO_FOG);
}

// lattice_weight of the only lattice, at p along its axes.
fn weight_alone(p: vec3f) -> f32 {
    let inside = min(alone.risen + p * alone.rise, alone.fallen - p * alone.fall);
    return saturate(min(inside.x, min(inside.y, inside.z)));
}

// warped_axis on all three, one division each.
fn warped_alone(coordinates: vec3f, cell: vec3f, low: vec3f, high: vec3f) -> vec3f {
    let t = coordinates - cell;
    let is_below = t < low;
    let is_above = (t > 1.0 + high) & !is_below;
    let width = select(select(max(1.0 + high - low, vec3f(0.25)), 1.0 - high, is_above),
        1.0 + low, is_below);
    return cell + select(vec3f(0.0), vec3f(1.0), is_above)
        + (t - select(low, 1.0 + high, is_above)) / width;
}

// How open a face has to be for its neighbour to be mixed in, as open_fraction has it.
const OPEN_FROM = vec3f(0.15);
const OPEN_TO = vec3f(0.5);

// lattice_eased(warped_coordinates(p)) of the only lattice, p along its axes.
fn eased_alone(p: vec3f) -> vec3f {
    let lattice = first_lattices();
    let coordinates = (p - alone.origin) * alone.per_metre;
    let cell = clamp(floor(coordinates), vec3f(0.0), alone.last);
    let warped = warped_alone(coordinates, cell, wall_shifts_low(lattice, vec3i(cell)),
        wall_shifts_high(lattice, vec3i(cell)));
    let there = clamp(floor(warped), vec3f(0.0), alone.last);
    let texel = lattice_texel(lattice, vec3i(there));
    let xy = textureLoad(lattice_visibility_a, texel, 0);
    let z = textureLoad(lattice_visibility_b, texel, 0);
    let t = clamp(warped - there, vec3f(0.0), vec3f(1.0)) - 0.5;
    let low = smoothstep(OPEN_FROM, OPEN_TO, vec3f(xy.x, xy.z, z.x));
    let high = smoothstep(OPEN_FROM, OPEN_TO, vec3f(xy.y, xy.w, z.y));
    let inside = there + 0.5 + t * select(low, high, t > vec3f(0.0));
    return (clamp(inside, vec3f(0.5), alone.count - 0.5) + alone.first) * alone.per_texel;
}

fn lattice_enter(p: vec3f) {
    // A single lattice: its coordinates, and how far it has faded.
    if (LATTICES_AT_ONCE == 1u) {
        let own_p = lattice_axes * p;
        let uvw = eased_alone(own_p);
        lattice_at[0] = vec4f(uvw, weight_alone(own_p));
        lattice_gain[0] = 1.0;
        return;
    }
    let last = arrayLength(&lattices) - 1u;
    for (var i = 0u; i < LATTICES_AT_ONCE; i++) {
        lattice_at[i].w = 0.0;
    }
    // The finest first, each with what finer ones leave of the point.
    var left = 1.0;
    var found = 0u;
    var k = 0u;
    loop {
        let weight = left * lattice_weight(lattices[k], p);
        if (weight > 0.0) {
            let finer = lattices[last].cell / lattices[k].cell;
            let uvw = coordinates_in_medium(lattices[k], p);
            lattice_at[found] = vec4f(uvw, weight);
            lattice_gain[found] = finer * finer;
            left -= weight;
            found++;
        }
        k++;
        if (k > last || left <= 0.0) {
            break;
        }
        if (found >= LATTICES_AT_ONCE) {
            // Where more fade into each other the largest of these has the share of those left out.
            lattice_at[LATTICES_AT_ONCE - 1u].w += left;
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

// Cells of the finest lattice that has the point, over the finest lattice's.
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

// `travel`: along the lattices' axes.
fn lattice_radiance(state: vec4f, travel: vec3f, direct: f32) -> f32 {
    return max(0.0, state.x + direct * dot(state.yzw, travel));
}
