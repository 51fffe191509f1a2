// Light scattered twice or more that is deflected once; see maths/forward_phase.py. The including pass binds
// `fused`, a table for each mean cosine g that media have: rgb by that of each channel.

const FUSED_COSINES = 64u;
const FUSED_DEPTHS = 32u;
const FUSED_LAST = 0.9756097560975610;

fn fused_row(first: u32, column: u32, f: f32) -> vec3f {
    return mix(fused[first + column].rgb, fused[first + column + 1u].rgb, f);
}

// Of medium m at a scattering depth, sr^-1.
fn fused_phase(m: u32, mu: f32, depth: f32) -> vec3f {
    return fused_table(phase_of(m), mu, depth);
}

// Which of the mean cosines medium m has.
fn phase_of(m: u32) -> u32 {
    return select(row_of_media(m).phase, 0u, MEDIA_COUNT == 1u);
}

fn fused_table(k: u32, mu: f32, depth: f32) -> vec3f {
    let x = sqrt(sqrt(saturate(0.5 - 0.5 * mu))) * f32(FUSED_COSINES - 1u);
    let y = min(depth / (1.0 + depth) / FUSED_LAST, 1.0) * f32(FUSED_DEPTHS - 1u);
    let column = min(u32(x), FUSED_COSINES - 2u);
    let row = min(u32(y), FUSED_DEPTHS - 2u);
    let first = (k * FUSED_DEPTHS + row) * FUSED_COSINES;
    let f = x - f32(column);
    return mix(fused_row(first, column, f), fused_row(first + FUSED_COSINES, column, f),
        y - f32(row));
}
