// Every texel of a reflective shadow map, or every block of texels, is a virtual point light, whose
// cosine lobe enters the cell half a cell in front of it (Kaplanyan2010 section 3.1; twin of the lobe:
// maths.sh.cosine_lobe), or farther where it is flat and oblique to the cells.
// The including pass says what of a layer's light arrives at a point: light_arriving(layer, p).
//! use lattice_space
//! use lobes
//! use light_texel
//! use flat_surfaces
//! use obliqueness
//! needs fn light_arriving(layer: u32, p: vec3f) -> vec3f

const PLANE = 0.1;       // cells: how far from a plane what counts as part of it may be
const ENTERS = 0.501;    // cells before a surface: half a one, and by no rounding less

// 0 for objects up to a size, 1 for those half as large again.
fn large_enough(size: f32, least: f32) -> f32 {
    return select(smoothstep(least, 1.5 * least, size), 1.0, least <= 0.0);
}

// The share that counts of an object's light: small ones would flicker from cell to cell. What is
// too small for the next larger lattice fades out where that takes over.
fn object_share(size: f32, p: vec3f) -> f32 {
    if (size <= 0.0 && params.has_static == 0u) {
        return 1.0;
    }
    let beyond = large_enough(abs(size), params.next_least);
    let share = large_enough(abs(size), params.least);
    return share * select(mix(lattice_weight(lattice, p), 1.0, beyond), 1.0, beyond >= 1.0);
}

// What texels show of one surface: sums over them of places, normals and W.
struct Seen { place: vec3f, normal: vec3f, power: vec3f, size: f32, texels: f32 }

// Whether a texel that shows p, of this normal and an object of this size, belongs to it.
fn is_of(seen: Seen, p: vec3f, n: vec3f, size: f32) -> bool {
    let along = seen.normal / seen.texels;
    return size == seen.size && dot(n, along) > 0.9
        && abs(dot(p - seen.place / seen.texels, along)) < PLANE * lattice.cell;
}

// Its flux: half a cell before it, where it is not in the cell of the wall itself. Cells that a flat surface oblique to
// them cuts hold the light of both its sides, and the steps of faces that it closes let it through: farther before that,
// unless another wall is so close.
fn add_seen(seen: Seen, view: LightViewData, layer: u32) {
    if (seen.texels <= 0.0) {
        return;
    }
    let p = seen.place / seen.texels;
    let share = object_share(seen.size, p);
    if (share > 0.0) {
        // Where the surface is among the cells, and the power that it sends.
        let n = lattice_from_world(lattice, normalize(seen.normal));
        let warped = warped_surface_coordinates(lattice, p, n);
        let upright = warped + ENTERS * n;
        let power = share * light_arriving(layer, p) * seen.power;
        let oblique = select(0.0, obliqueness(n, OBLIQUE), lobes.is_raised != 0u);
        // A share of it moves, not where it enters: that would jump from cell to cell. Nor does it leave the lattice.
        var is_oblique = oblique > 0.0;
        var coordinates = upright;
        var entering = select(power, vec3f(0.0), is_oblique);
        var sharpness = lobes.lobe;
        loop {
            add_sharp_lobe(coordinates, n, sharpness, entering);
            if (!is_oblique) { break; }
            is_oblique = false;
            coordinates = plane_coordinates(lattice, p, warped, n) + BEFORE_FLAT * n;
            let is_inside = all(coordinates >= vec3f(0.0)) && all(coordinates < vec3f(lattice.count));
            let sight = sight_of(view, p, n);
            let moving = oblique * flatness(sight, layer, n) * clearance(sight, layer, n);
            let moved = select(0.0, moving, is_inside);
            add_lobe(upright, n, (1.0 - moved) * power);
            entering = moved * power;
            sharpness = free_sharpness(n);
        }
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy * params.block >= vec2u(params.resolution)) || id.z >= params.layers) {
        return;
    }
    // A block is one light for the surface that its first texel shows, and one for whatever else is in
    // it: an edge that moves brings light by the texel, at the cost of a light for each block.
    let view = row_of_views(id.z);
    var first = Seen(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0);
    var other = first;
    for (var k = 0u; k < params.block * params.block; k++) {
        let texel = id.xy * params.block + vec2u(k % params.block, k / params.block);
        let power_density = view.flux_unit * textureLoad(flux, texel, id.z, 0).rgb;
        let d = textureLoad(depth, texel, id.z, 0);
        if (any(texel >= vec2u(params.resolution)) || d >= 1.0
            || all(power_density <= vec3f(0.0))) {
            continue;
        }
        // The surface that the texel shows, and its flux.
        let centre = texel_centre(texel, params.resolution);
        let facing = textureLoad(normal, texel, id.z, 0);
        let n = normalize(facing.xyz);
        let p = texel_point(view, centre, d);
        let power = power_density * texel_measure(view, centre, params.resolution);
        // No flux is lost: a third surface's counts as the second's.
        if (first.texels == 0.0 || is_of(first, p, n, facing.w)) {
            first = Seen(first.place + p, first.normal + n, first.power + power, facing.w,
                first.texels + 1.0);
        } else if (other.texels == 0.0 || is_of(other, p, n, facing.w)) {
            other = Seen(other.place + p, other.normal + n, other.power + power, facing.w,
                other.texels + 1.0);
        } else {
            other.power += power;
        }
    }
    // A loop, because a CPU adapter leaves a loop where none of its lanes goes on, and no branch.
    loop {
        add_seen(first, view, id.z);
        if (other.texels <= 0.0) { break; }
        first = other;
        other.texels = 0.0;
    }
}
