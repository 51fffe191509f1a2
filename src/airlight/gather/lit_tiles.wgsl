// What a light shines on, a tile of texels of its map at a time, and how much of that points of the image see.
//! use light_texel
//! use rays
//! use sampling
//! use tone

const TRIED = 8u;           // points of the image
const NEAR = 10.0;          // of a texel's reach: how far off the rest of a tile is that belongs to it; its corners are 16 apart
const SPREAD = 1.73;        // from the root of the mean squared distance to the corners of an even square
const ABOVE = 1e-3;        // of the distance to a point: where rays start above a lit surface

// Even bits of a Morton code.
fn even_bits(code: u32) -> u32 {
    var x = code & 0x55555555u;
    x = (x | (x >> 1u)) & 0x33333333u;
    x = (x | (x >> 2u)) & 0x0f0f0f0fu;
    x = (x | (x >> 4u)) & 0x00ff00ffu;
    return (x | (x >> 8u)) & 0x0000ffffu;
}

// How much of what leaves `start` with normal n some points of the image get, about: per unit of its flux, m^-2.
fn seen_by_points(seed: u32, start: vec3f, n: vec3f, spread: f32) -> f32 {
    var sum = 0.0;
    for (var k = 0u; k < TRIED; k++) {
        let hash = pcg_hash(seed + pcg_hash(k));
        let at = vec2u(hash % params.reduced.x, pcg_hash(hash) % params.reduced.y);
        let place = textureLoad(places, at, 0);
        let facing = textureLoad(normals, at, 0).xyz;
        let offset = place.xyz - start;
        let d2 = max(dot(offset, offset), 1e-12);
        let along = offset * inverseSqrt(d2);
        let cosines = max(dot(n, along), 0.0) * max(-dot(facing, along), 0.0);
        if (place.w > 0.0 && cosines > 0.0) {
            let raised = ABOVE * sqrt(d2);
            if (!any_hit(start + raised * n, along, 0.0, sqrt(d2) * (1.0 - 4.0 * ABOVE))) {
                sum += cosines / (d2 + spread);
            }
        }
    }
    return sum / f32(TRIED);
}

struct LitTexel {
    place: vec3f,           // m
    normal: vec3f,
    flux: f32,              // W, luminance
    reach: f32,             // m, from its middle to its corners
}

fn lit_texel(texel: vec2u, layer: u32) -> LitTexel {
    if (any(texel >= vec2u(params.resolution))) {
        return LitTexel();
    }
    let view = row_of_views(layer);
    let d = textureLoad(depth, vec2i(texel), layer, 0);
    let power = luminance(view.flux_unit * textureLoad(flux, vec2i(texel), layer, 0).rgb);
    if (d >= 1.0 || power <= 0.0) {
        return LitTexel();
    }
    let clip = texel_centre(texel, params.resolution);
    let p = texel_point(view, clip, d);
    let n = normalize(textureLoad(normal, vec2i(texel), layer, 0).xyz);
    // How wide it is across the light, and on a surface at most four times as much.
    let deep = select(1.0, (view.clip_from_world * vec4f(p, 1.0)).w, view.is_perspective == 1u);
    let towards = view.world_from_clip * vec4f(clip, d * 0.5, 1.0);
    let along = normalize(p - towards.xyz / towards.w);
    let reach = 0.7071 * deep * max(view.texel.x, view.texel.y) / max(abs(dot(n, along)), 0.25);
    return LitTexel(p, n, power * texel_measure(view, clip, params.resolution), reach);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let each = params.side * params.side;
    if (id.x >= each * params.layers) {
        return;
    }
    // Tiles along a Morton curve, so that neighbours in a row are neighbours on the map.
    let layer = id.x / each;
    let code = id.x % each;
    let first = TILE * vec2u(even_bits(code), even_bits(code >> 1u));
    // One lit texel, by its flux, from which points are looked for.
    var total = 0.0;
    var start = LitTexel();
    var number = uniform_from_hash(pcg_hash(id.x));
    for (var k = 0u; k < TILE * TILE; k++) {
        let lit = lit_texel(first + vec2u(k % TILE, k / TILE), layer);
        if (lit.flux <= 0.0) { continue; }
        total += lit.flux;
        let share = lit.flux / total;
        let is_taken = number < share;
        number = select((number - share) / max(1.0 - share, 1e-9), number / share, is_taken);
        if (is_taken) { start = lit; }
    }
    var out: LitTile;
    if (total > 0.0) {
        // What is near to it stands for the tile: others, behind an edge, are as likely to have been taken as they are bright.
        var sum = 0.0;
        var squares = 0.0;
        for (var k = 0u; k < TILE * TILE; k++) {
            let lit = lit_texel(first + vec2u(k % TILE, k / TILE), layer);
            let offset = lit.place - start.place;
            if (lit.flux > 0.0 && length(offset) <= NEAR * start.reach) {
                sum += lit.flux;
                squares += lit.flux * dot(offset, offset);
                out.centre += lit.flux * offset;
                out.normal += lit.flux * lit.normal;
            }
        }
        let middle = out.centre / sum;
        out.centre = start.place + middle;
        out.normal /= sum;
        out.flux = total;
        out.radius = SPREAD * sqrt(max(squares / sum - dot(middle, middle), 0.0)) + start.reach;
        out.seen = seen_by_points(params.first_tile + id.x, start.place, start.normal, params.near2);
    }
    tiles[params.first_tile + id.x] = out;
}
