// The 26 hops out of a cell: 6 across its faces, 12 across its edges, 8 across its corners; kinds 0, 1, 2.
// maths.lattice26.hops and maths.lattice26_walls have the same numbers in float64.
//! use medium

const RHO = 0.93;                       // share of a cell's net direction that a hop sees
const HOP_WEIGHTS = vec3f(0.05387967318, 0.03516105913, 0.03184865642);     // by kind
const HOP_LENGTHS = vec3f(1.0, 1.414213562, 1.732050808);                   // by kind, cells
const MEAN_HOP = 1.361288928;           // mean length of isotropic light's hops, cells
const RETURNED = 1.525681826;           // net direction of reflected power, along the wall's normal
const REFLECTED_TRACK = 0.6666666667;   // the same of the track of reflected power
const SPLIT_FLOOR = 0.001;              // keeps the split of a stopped hop over open faces defined

// The number of the hop by an offset; 26 less that is the hop back, and 13 would be the cell itself.
fn hop_number(offset: vec3i) -> u32 {
    return u32(13 + offset.x + 3 * offset.y + 9 * offset.z);
}

fn hop_offset(number: u32) -> vec3i {
    return vec3i(vec3u(number % 3u, (number / 3u) % 3u, number / 9u)) - 1;
}

fn hop_kind(offset: vec3i) -> u32 {
    return u32(abs(offset.x) + abs(offset.y) + abs(offset.z)) - 1u;
}

// Track of isotropic light per hop, m, by channel; maths.lattice26.mean_track.
fn mean_track(sigma_t: vec3f, cell: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var kind = 0u; kind < 3u; kind++) {
        let length = HOP_LENGTHS[kind];
        sum += vec3f(6.0, 12.0, 8.0)[kind] * HOP_WEIGHTS[kind] * length
            * mean_transmittance_rgb(sigma_t * (cell * length));
    }
    return cell * sum;
}
