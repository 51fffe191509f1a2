// The reduced coefficients of volumes in the cells of a lattice, m^-1, and how the extinction is spread in each.
//! use media
//! use lattice_axes
//! use cell_order
//! use column_spread

// Whether a cell touches a medium's box at all; most do not, and sampling costs.
fn touches(m: u32, centre: vec3f) -> bool {
    let half = 0.5 * lattice.cell;
    let to = row_of_media(m).volume_from_world;
    let across = mat3x3f(to[0].xyz, to[1].xyz, to[2].xyz)
        * mat3x3f(lattice.axis_x, lattice.axis_y, lattice.axis_z);
    let reach = half * (abs(across[0]) + abs(across[1]) + abs(across[2]));
    let inside = medium_coordinates(m, centre);
    return all(inside > -reach) && all(inside < 1.0 + reach);
}

// Depths that differ by less than this have the same transmittance, to a unit in 255.
const ALIKE = 0.2;

// Of a hop along the axes light's path is so much, for what it absorbs (maths/two_streams.py).
const ALONG_HOPS = 0.8;

// The extinction of a cell's samples, m^-1.
var<private> samples: array<f32, SAMPLE_COUNT>;

// Of half a column towards a face, the middle sample's share is a half.
fn half_extinction(h: u32) -> f32 {
    let face = h / COLUMNS;
    let column = h % COLUMNS;
    let axis = face / 2u;
    let stride = vec3u(1u, SAMPLES, SAMPLES * SAMPLES);
    var at = column % SAMPLES * stride[(axis + 1u) % 3u] + column / SAMPLES * stride[(axis + 2u) % 3u];
    at += SAMPLES / 2u * stride[axis];
    let one = select(stride[axis], 0u - stride[axis], (face & 1u) == 1u);
    return 0.4 * (0.5 * samples[at] + samples[at + one] + samples[at + 2u * one]);
}

// How the samples of a cell of mean extinction `mean` are spread.
fn store_spread(cell: u32, mean: f32) {
    // Of cells whose samples are alike the mean says all, and no shares are stored.
    var largest = 0.0;
    var least = 1e30;
    for (var h = 0u; h < params.halves; h++) {
        let here = half_extinction(h);
        largest = max(largest, here);
        least = min(least, here);
    }
    let is_alike = (largest - least) * lattice.cell < ALIKE;
    spread[SPREAD_WORDS * cell + LARGEST_WORD] = bitcast<u32>(select(largest / max(mean, 1e-20), 0.0, is_alike));
    if (is_alike) { return; }
    // Else half a column towards each face by its share of the densest, in four bits.
    for (var word = 0u; word * HALVES_PER_WORD < params.halves; word++) {
        var bits = 0u;
        for (var k = 0u; k < HALVES_PER_WORD; k++) {
            let h = min(HALVES_PER_WORD * word + k, HALVES - 1u);
            bits |= u32(round(HALF_STEPS * half_extinction(h) / largest)) << (4u * k);
        }
        spread[SPREAD_WORDS * cell + word] = bits;
    }
}

// rgb: scattering of the reduced medium; a: its extinction, the mean of three channels; m^-1.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    var scattering = vec3f(0.0);
    for (var s = 0u; s < params.samples; s++) {
        samples[s] = 0.0;
    }
    // Each medium that touches the cell adds to all samples; no other one is sampled.
    let centre = world_from_cells(lattice, vec3f(id) + 0.5);
    // Turned cells reach farther along the world's axes.
    let reach = 0.8660254 * lattice.cell;
    var node = 0u;
    for (var v = 0u; v < MEDIA_NODES; v++) {
        let visit = visit_near(node, centre, reach);
        node = visit.next;
        if (visit.is_done) { break; }
        if (visit.is_skipped) { continue; }
        let m = visit.medium;
        let count = select(0u, params.samples, touches(m, centre));
        // Similarity theory: sigma_s (1 - g), and the absorption, less as hops are longer than light's path.
        let scattered = row_of_media(m).sigma_t * row_of_media(m).albedo;
        let lost = scattered * (1.0 - row_of_media(m).g) + ALONG_HOPS * (row_of_media(m).sigma_t - scattered);
        let extinction = (lost.r + lost.g + lost.b) / 3.0;
        var density = 0.0;
        for (var s = 0u; s < count; s++) {
            let inside = (vec3f(cell_at_index(vec3u(SAMPLES), s)) + 0.5) / f32(SAMPLES);
            let here = medium_density(m, world_from_cells(lattice, vec3f(id) + inside));
            density += here;
            samples[s] += here * extinction;
        }
        scattering += density * scattered * (1.0 - row_of_media(m).g);
    }
    // The means, and how the extinction is spread about its own.
    var extinction = 0.0;
    for (var s = 0u; s < params.samples; s++) {
        extinction += samples[s];
    }
    let cell = cell_in(lattice.count, id);
    let mean = vec4f(scattering, extinction) / f32(SAMPLE_COUNT);
    cells[cell] = mean;
    store_spread(cell, mean.a);
}
