//! use footprint
//! use two_words

// Maps of materials in one buffer, as surface/packed_maps.py lays them out, filtered as samplers do.
// Who uses it binds `texels: array<u64>`:
// CPU adapters load 8 bytes as fast as 4.

const MAPS_NORMAL = 1u;
const MAPS_ROUGHNESS = 2u;
const MAPS_BASE = 4u;
const MAPS_ONE_SIDED = 8u;    // of the material: its back is black

struct PackedTexel {
    light: vec3f,   // base colour, linear
    surface: vec4f, // the normal map's xyz, 0 to 1; roughness
}

struct TexelPair {
    near: u32,
    far: u32,
    share: f32,     // of the far one
}

// The two texels of a row, or of a column, of `count` around `u`. `wrap`: 0 repeat, 1 mirror, 2 clamp.
fn texel_pair(u: f32, count: u32, wrap: u32) -> TexelPair {
    // The coordinate as it is wrapped, in texels; one beyond the border is the one at it, or at the other side.
    let mirrored = abs(u - 2.0 * floor(u * 0.5 + 0.5));
    var s = select(fract(u), mirrored, wrap == 1u);
    s = select(s, clamp(u, 0.0, 1.0), wrap == 2u) * f32(count) - 0.5;
    let first = floor(s);
    let a = i32(first);
    let n = i32(count);
    let inside = vec2i(max(a, 0), min(a + 1, n - 1));
    let around = vec2i(select(a, a + n, a < 0), select(a + 1, 0, a + 1 >= n));
    let pair = select(inside, around, wrap == 0u);
    return TexelPair(u32(pair.x), u32(pair.y), s - first);
}

// Adds a level's four texels around `uv` by their weights, of `share` together.
fn add_level(sum: PackedTexel, begin: u32, size: vec2u, uv: vec2f, flags: u32, share: f32) -> PackedTexel {
    let x = texel_pair(uv.x, size.x, (flags >> 4u) & 3u);
    let y = texel_pair(uv.y, size.y, (flags >> 6u) & 3u);
    let upper = begin + y.near * size.x;
    let lower = begin + y.far * size.x;
    let below = y.share * share;
    let above = share - below;
    let b = above * x.share;
    let d = below * x.share;
    var total = add_texel(sum, texels[upper + x.near], above - b);
    total = add_texel(total, texels[upper + x.far], b);
    total = add_texel(total, texels[lower + x.near], below - d);
    return add_texel(total, texels[lower + x.far], d);
}

fn add_texel(sum: PackedTexel, bits: u64, weight: f32) -> PackedTexel {
    let texel = two_words(bits);
    let root = vec3f((vec3u(texel.x) >> vec3u(0u, 10u, 20u)) & vec3u(1023u));
    let byte = vec4f((vec4u(texel.y) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u));
    return PackedTexel(sum.light + (root * root) * weight, sum.surface + byte * weight);
}

// Adds the two levels around `lod` at `uv`, of `share` together; `maps` as packed_maps_at has them.
fn add_levels(sum: PackedTexel, maps: vec4u, size: vec2u, uv: vec2f, lod: f32, share: f32) -> PackedTexel {
    let level = u32(lod);
    let coarser = (lod - f32(level)) * share;
    let begins = two_words(texels[maps.x + level]);
    let next = min(level + 1u, maps.w - 1u);
    let fine = max(size >> vec2u(level), vec2u(1u));
    let coarse = max(size >> vec2u(next), vec2u(1u));
    let total = add_level(sum, begins.x, fine, uv, maps.z, share - coarser);
    return add_level(total, begins.y, coarse, uv, maps.z, coarser);
}

// `maps` is (first, width | height << 16, flags, levels), dx and dy the gradients of uv.
fn packed_maps_at(maps: vec4u, uv: vec2f, dx: vec2f, dy: vec2f) -> PackedTexel {
    let size = vec2u(maps.y & 0xffffu, maps.y >> 16u);
    let over = footprint(vec2f(size), uv, dx, dy);
    let lod = clamp(over.lod, 0.0, f32(maps.w - 1u));
    var sum = PackedTexel(vec3f(0.0), vec4f(0.0));
    var k = 0.0;
    loop {
        sum = add_levels(sum, maps, size, over.first + k * over.step, lod, 1.0 / over.probes);
        k += 1.0;
        if (k >= over.probes) { break; }
    }
    return scaled(sum);
}

// The texel at uv of the level whose texels are as large as the footprint is long.
fn packed_maps_near(maps: vec4u, uv: vec2f, dx: vec2f, dy: vec2f) -> PackedTexel {
    let size = vec2u(maps.y & 0xffffu, maps.y >> 16u);
    let length = max(dot(dx * vec2f(size), dx * vec2f(size)), dot(dy * vec2f(size), dy * vec2f(size)));
    let level = u32(clamp(0.5 * log2(max(length, 1e-12)) + 0.5, 0.0, f32(maps.w - 1u)));
    let count = max(size >> vec2u(level), vec2u(1u));
    let x = texel_pair(uv.x + 0.5 / f32(count.x), count.x, (maps.z >> 4u) & 3u).near;
    let y = texel_pair(uv.y + 0.5 / f32(count.y), count.y, (maps.z >> 6u) & 3u).near;
    let at = two_words(texels[maps.x + level]).x + y * count.x + x;
    return scaled(add_texel(PackedTexel(vec3f(0.0), vec4f(0.0)), texels[at], 1.0));
}

fn scaled(sum: PackedTexel) -> PackedTexel {
    return PackedTexel(sum.light * (1.0 / (1023.0 * 1023.0)), sum.surface * (1.0 / 255.0));
}
