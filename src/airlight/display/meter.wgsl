//! use tone

// Bins of a sixteenth of a stop, from -24 to +24 stops of luminance.
const BINS = 768u;
const PER_STOP = 16.0;
const LOWEST = -24.0;
const LOOKED_AT = 96u;

var<workgroup> counts: array<atomic<u32>, BINS>;

@compute @workgroup_size(WX, WY, WZ)
fn main(@builtin(local_invocation_index) self_index: u32) {
    for (var bin = self_index; bin < BINS; bin += WX) {
        atomicStore(&counts[bin], 0u);
    }
    workgroupBarrier();
    // A histogram of log2 luminance, of pixels on a grid over the image; black ones say nothing.
    let grid = min(params.size, vec2u(LOOKED_AT));
    for (var i = self_index; i < grid.x * grid.y; i += WX) {
        let place = vec2u(i % grid.x, i / grid.x);
        let pixel = (place * 2u + 1u) * params.size / (2u * grid);
        let y = luminance(finite_or_zero(textureLoad(image, vec2i(pixel), 0).rgb));
        if (y > 0.0) {
            let bin = clamp((log2(y) - LOWEST) * PER_STOP, 0.0, f32(BINS - 1u));
            atomicAdd(&counts[u32(bin)], 1u);
        }
    }
    workgroupBarrier();
    // The exposure goes towards it by a share, so that it follows an image that moves without flicker.
    if (self_index == 0u) {
        metered[0] = mix(metered[0], exposure(), params.speed);
    }
}

// The darkest 5% and the brightest 2% count as what stands at those percentiles.
fn exposure() -> f32 {
    var total = 0.0;
    for (var bin = 0u; bin < BINS; bin++) {
        total += f32(atomicLoad(&counts[bin]));
    }
    if (total == 0.0) {
        return 0.0;
    }
    // The mean of log2 luminance between both percentiles.
    let low = 0.05 * total;
    let high = 0.98 * total;
    var below = 0.0;
    var sum = 0.0;
    for (var bin = 0u; bin < BINS; bin++) {
        let count = f32(atomicLoad(&counts[bin]));
        let stops = LOWEST + (f32(bin) + 0.5) / PER_STOP;
        var inner = max(0.0, min(below + count, high) - max(below, low));
        // The bins that hold a percentile speak for all beyond it.
        if (below <= low && low < below + count) { inner += low; }
        if (below < high && high <= below + count) { inner += total - high; }
        sum += inner * stops;
        below += count;
    }
    // In stops: that mean becomes the middle grey of a reflectance of 18 %.
    return log2(0.18) - sum / total;
}
