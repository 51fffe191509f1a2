// How a map is read over a pixel's footprint: trilinear probes along the footprint's longer axis, as many as
// it is longer than wide. Samplers know that, too, but each driver does it differently (lavapipe's is
// wrong for maps with a scale), and the CPU paths read maps without samplers.

const MOST_PROBES = 8.0;

struct Footprint {
    probes: f32,
    lod: f32,           // of each probe; below 0 where texels are larger than pixels
    first: vec2f,       // uv of the first probe
    step: vec2f,        // from one to the next
}

// `size`: the map's, texels; `dx` and `dy`: what `uv` changes by from a pixel to the next.
fn footprint(size: vec2f, uv: vec2f, dx: vec2f, dy: vec2f) -> Footprint {
    let along_x = dx * size;
    let along_y = dy * size;
    let squares = vec2f(dot(along_x, along_x), dot(along_y, along_y));
    let longer = max(max(squares.x, squares.y), 1e-20);
    let shorter = max(min(squares.x, squares.y), 1e-20);
    let ratio = clamp(sqrt(longer / shorter), 1.0, MOST_PROBES);
    // Almost square ones need but one, and so do those within a texel.
    let probes = select(1.0, ceil(ratio - 0.05), longer > 1.0);
    let lod = 0.5 * log2(longer) - log2(min(ratio, probes));
    let step = select(dy, dx, squares.x > squares.y) / probes;
    return Footprint(probes, lod, uv - (0.5 * (probes - 1.0)) * step, step);
}
