// Where surfaces read a lattice: those that are oblique to its cells, those that stand beside such, and all others. The
// including pass binds what lattice needs, and lattice_planes (the oblique plane that each cell is near, see oblique_plane).
//! use lattice
//! use obliqueness

// Sines between an oblique plane and an axis: closed faces across it are other walls' up to the first, the plane's
// own steps from the second on.
const OWN_STEPS = vec2f(0.2, 0.4);
// How far from its plane an oblique surface is looked up, cells along its normal.
const BEFORE_OBLIQUE = 0.75;
// Cells whose middles are so far from its plane lie behind it, and before it.
const BEHIND_PLANE = -0.1;
const BEFORE_PLANE = 0.3;
// What those behind it count, for points of which none is before it.
const LEAST_BEFORE = 1e-4;

// From there on all of a cell is before the plane: what closes it farther on is another wall.
const WHOLE_CELL = vec2f(0.35, 0.6);

// The shares of the eight cells between which a point is interpolated: of the four that are its own along x, and of
// those beside them. Each four: the point's own, the one beside along y, along z, and along both.
struct EightShares { own: vec4f, beside: vec4f }

// As far as they are before a plane of normal n, from which the middle of the point's own cell is so far; `offset` leads
// from there to the point.
fn shares_before(distance: f32, offset: vec3f, n: vec3f) -> EightShares {
    let step = sign(offset) * n;
    let t = abs(offset);
    let across = vec4f((1.0 - t.y) * (1.0 - t.z), t.y * (1.0 - t.z), (1.0 - t.y) * t.z, t.y * t.z);
    let own = distance + vec4f(0.0, step.y, step.z, step.y + step.z);
    let low = vec4f(BEHIND_PLANE);
    let high = vec4f(BEFORE_PLANE);
    return EightShares((1.0 - t.x) * across * (smoothstep(low, high, own) + LEAST_BEFORE),
        t.x * across * (smoothstep(low, high, own + step.x) + LEAST_BEFORE));
}

// The oblique plane before which a surface is looked up, in cells.
struct PlaneBefore {
    base: vec3f,        // where the surface is
    raised: vec3f,      // where it is wanted to look, before the plane
    point: vec3f,       // of the plane
    n: vec3f,           // its unit normal
    is_own: vec3f,      // how far faces closed across each axis are steps of the plane; others are of other walls
    is_body: bool,      // behind it is a body: faces that enclose cells towards n are never its own
    share: f32,         // how far the surface is looked up so
}

// How far all of a cell is before it: what closes that one farther on is another wall.
fn is_whole(plane: PlaneBefore, cell: vec3f) -> f32 {
    return smoothstep(WHOLE_CELL.x, WHOLE_CELL.y, dot(cell + 0.5 - plane.point, plane.n));
}

// Texture coordinates before such a plane. The faces that it closes are steps before and behind it, which would show as
// plates. So cells count by how far their middles lie before it, which leaves out those that hold the light of its other
// side; closed faces end interpolation only where they are another wall's.
fn coordinates_before(lattice: LatticeParams, plane: PlaneBefore) -> vec3f {
    let n = plane.n;
    let first = floor(plane.base + BEFORE * n);
    let goes_through = plane.is_own * select(1.0 - is_whole(plane, first), 0.0, plane.is_body);
    let before = mix(before_walls(lattice, plane.base, plane.raised, n), plane.raised, goes_through);
    let at = clamp(before, vec3f(0.5), vec3f(lattice.count) - 0.5);
    let cell = floor(at);
    let t = at - cell - 0.5;
    let others = select(vec3f(is_whole(plane, cell)), select(vec3f(0.0), vec3f(1.0), ends(lattice, cell, n)),
        plane.is_body);
    let passes = plane.is_own * (1.0 - select(vec3f(0.0), others, t * n > vec3f(0.0)));
    let offset = mix(open_offset(lattice, cell, t, vec3f(0.0)), t, passes);
    // One filtered tap has one share on each axis: of all cells that are beside the point's own along it. Each of the eight
    // counts by its own distance, so that nothing jumps where the point goes over from cell to cell.
    let shares = shares_before(dot(cell + 0.5 - plane.point, n), offset, n);
    let both = shares.own + shares.beside;
    let beside = vec3f(dot(shares.beside, vec4f(1.0)), both.y + both.w, both.z + both.w);
    return lattice_uvw(lattice, cell + 0.5 + sign(offset) * beside / dot(both, vec4f(1.0)));
}

// That of a surface oblique to the cells: its own.
fn own_plane(lattice: LatticeParams, position: vec3f, warped: vec3f, n: vec3f, oblique: f32) -> PlaneBefore {
    let point = plane_coordinates(lattice, position, warped, n);
    let base = lifted(lattice, point, n);
    // Its own steps enclose cells across axes that it faces more, other walls across the others.
    let is_own = smoothstep(vec3f(OWN_STEPS.x), vec3f(OWN_STEPS.y), abs(n));
    return PlaneBefore(base, base + BEFORE_OBLIQUE * n, point, n, is_own, false, oblique);
}

// Cells from an oblique plane up to which what is beside it is looked up before it, and from which on it is not.
const BESIDE_PLANE = vec2f(1.0, 1.5);
// Cosines between a surface and that plane from which on it may be a part of it.
const OF_PLANE = vec2f(0.7, 0.9);
// By rounding, what touches a body may be so far behind its plane, cells.
const ON_PLANE = 0.004;

// That of an oblique surface which one along the cells may stand beside: the floor at the foot of a board. There a cell may
// belong to the other side of the board, or to the inside of a body, so the floor is looked up before the board's plane as
// the board itself is, on the side where the point is. `at`: its lookup_coordinates.
fn plane_beside(lattice: LatticeParams, position: vec3f, at: vec3f, n: vec3f) -> PlaneBefore {
    // What is known of the cell that the surface is looked up in, but where the point really is along it.
    let is_facing = abs(n) > vec3f(0.5);
    let own = cells_from_world(lattice, position);
    let cell = clamp(floor(select(own, at, is_facing)), vec3f(0.0), vec3f(lattice.count) - 1.0);
    let stored = textureLoad(lattice_planes, lattice_texel(lattice, vec3i(cell)), 0);
    let size = length(stored.xyz);
    let is_thin = size > 1.5;
    let towards = stored.xyz / max(size, 1e-6);
    // The plane, and its normal on the side where the point is.
    let point = cell + 0.5 - stored.w * towards;
    let height = dot(own - point, towards);
    let m = select(-1.0, 1.0, height >= -ON_PLANE) * towards;
    // As far before it as it is itself looked up, along the surface.
    let is_own = select(smoothstep(vec3f(OWN_STEPS.x), vec3f(OWN_STEPS.y), abs(m)), vec3f(0.0), is_facing);
    let base = select(plane_coordinates(lattice, position, at, m), at, is_facing);
    let raise = max(BEFORE_OBLIQUE - abs(height), 0.0) * select(m, vec3f(0.0), is_facing);
    let is_near = 1.0 - smoothstep(BESIDE_PLANE.x, BESIDE_PLANE.y, abs(height));
    let is_other = 1.0 - smoothstep(OF_PLANE.x, OF_PLANE.y, abs(dot(m, n)));
    let counts = select(size, size - 2.0, is_thin);
    return PlaneBefore(base, base + raise, point, m, is_own, !is_thin, counts * is_near * is_other);
}

// Texture coordinates for a surface point of the world, m, and its normal along the lattice's axes.
fn lattice_coordinates(lattice: LatticeParams, position: vec3f, n: vec3f) -> vec3f {
    let warped = warped_lookup(lattice, position, n);
    let at = lookup_coordinates(lattice, warped, n);
    let upright = lattice_eased(lattice, at, rim_shares(n));
    if (lattice.is_paper != 0u) {
        return upright;
    }
    // Before its own plane if it is oblique to the cells, else before an oblique one beside it.
    var plane: PlaneBefore;
    let oblique = obliqueness(n, OBLIQUE);
    if (oblique > 0.0) {
        plane = own_plane(lattice, position, warped, n, oblique);
    } else {
        plane = plane_beside(lattice, position, at, n);
    }
    if (plane.share == 0.0) {
        return upright;
    }
    return mix(upright, coordinates_before(lattice, plane), plane.share);
}
