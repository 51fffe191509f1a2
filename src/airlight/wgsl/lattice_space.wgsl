// Where a world point is among the cells. The including pass binds lattice_walls (how far the walls
// on each cell's low faces really lie from them, in cells) and declares the struct LatticeParams.
//
// Blockers round walls to cell faces; up to half a cell before or behind a wall would then belong
// to a cell on its other side. So coordinates are warped: a piecewise linear map per axis takes every wall
// to the face it was rounded to.
//! use lattice_axes

// A cell's texel in the textures, which nested lattices share.
fn lattice_texel(lattice: LatticeParams, cell: vec3i) -> vec3i {
    return cell + vec3i(0, i32(lattice.first_row), 0);
}

fn wall_shifts_low(lattice: LatticeParams, cell: vec3i) -> vec3f {
    return textureLoad(lattice_walls, lattice_texel(lattice, cell), 0).xyz;
}

// A bit for each outgoing hop (+x -x +y -y +z -z) that ends at a wall before which light may be.
fn enclosed_faces(lattice: LatticeParams, cell: vec3i) -> u32 {
    return u32(127.0 * textureLoad(lattice_walls, lattice_texel(lattice, cell), 0).w + 0.5);
}

// How far the wall on its high face across one axis lies from it.
fn wall_shift_high(lattice: LatticeParams, cell: vec3i, axis: u32) -> f32 {
    var next = cell;
    next[axis] = min(cell[axis] + 1, i32(lattice.count[axis]) - 1);
    return select(0.0, wall_shifts_low(lattice, next)[axis], next[axis] > cell[axis]);
}

fn wall_shifts_high(lattice: LatticeParams, cell: vec3i) -> vec3f {
    return vec3f(wall_shift_high(lattice, cell, 0u), wall_shift_high(lattice, cell, 1u),
        wall_shift_high(lattice, cell, 2u));
}

// One coordinate, warped between walls that lie `low` and `high` from the faces of `cell`.
fn warped_axis(coordinates: f32, cell: i32, low: f32, high: f32) -> f32 {
    let t = coordinates - f32(cell);
    let between = (t - low) / max(1.0 + high - low, 0.25);
    let below = (t - low) / (1.0 + low);
    let above = 1.0 + (t - 1.0 - high) / (1.0 - high);
    return f32(cell) + select(select(between, above, t > 1.0 + high), below, t < low);
}

// The cell of a point, WHOLE_BEFORE cells along n from where it is on the other axes. Walls cover
// what they need to be known by at that distance from where they end.
const WHOLE_BEFORE = 0.75;

fn cell_before(lattice: LatticeParams, coordinates: vec3f, others: vec3f, n: vec3f, axis: u32) -> vec3i {
    var beyond = others + WHOLE_BEFORE * n;
    beyond[axis] = coordinates[axis];
    return clamp(vec3i(floor(beyond)), vec3i(0), vec3i(lattice.count) - 1);
}

// Coordinates warped on each axis between the walls that are known where the point is on the `others`.
fn warped_between(lattice: LatticeParams, coordinates: vec3f, others: vec3f, n: vec3f) -> vec3f {
    let x = cell_before(lattice, coordinates, others, n, 0u);
    let y = cell_before(lattice, coordinates, others, n, 1u);
    let z = cell_before(lattice, coordinates, others, n, 2u);
    let low = vec3f(wall_shifts_low(lattice, x).x, wall_shifts_low(lattice, y).y,
        wall_shifts_low(lattice, z).z);
    let high = vec3f(wall_shift_high(lattice, x, 0u), wall_shift_high(lattice, y, 1u),
        wall_shift_high(lattice, z, 2u));
    return vec3f(warped_axis(coordinates.x, x.x, low.x, high.x),
        warped_axis(coordinates.y, y.y, low.y, high.y), warped_axis(coordinates.z, z.z, low.z, high.z));
}

// Warped cells from the lattice's origin to a world point of a surface of normal n, which is along the
// lattice's axes, as all normals that a lattice is asked with. Where walls meet, the cells behind
// this one hardly know the others: they are looked up in front of it.
fn warped_surface_coordinates(lattice: LatticeParams, world: vec3f, n: vec3f) -> vec3f {
    let coordinates = cells_from_world(lattice, world);
    return warped_between(lattice, coordinates, coordinates, n);
}

// The same for lookups. In a corner three walls meet, and the cell in front of one may lie behind both others: a point
// that the warp takes out from behind one of them is asked again where the other is. A point of a medium (n = 0) is in
// front of none.
fn warped_lookup(lattice: LatticeParams, world: vec3f, n: vec3f) -> vec3f {
    let coordinates = cells_from_world(lattice, world);
    let warped = warped_between(lattice, coordinates, coordinates, n);
    let stays = floor(warped) == floor(coordinates);
    if (all(stays) || all(n == vec3f(0.0))) {
        return warped;
    }
    let again = warped_between(lattice, coordinates, warped, n);
    return select(warped, again, stays & (floor(again) != floor(coordinates)));
}

// From where on a surface's plane cuts an axis of the cells: the sines of 3 and 8 degrees.
const CUT = vec2f(0.05, 0.14);

// Where an oblique surface of normal n at a world point is: as it is on axes that its plane cuts, since the faces
// that it closes there are steps, and warped along the others, to the walls that it stands between.
fn plane_coordinates(lattice: LatticeParams, world: vec3f, warped: vec3f, n: vec3f) -> vec3f {
    return mix(warped, cells_from_world(lattice, world), smoothstep(vec3f(CUT.x), vec3f(CUT.y), abs(n)));
}

// The same for a point in space.
fn warped_coordinates(lattice: LatticeParams, world: vec3f) -> vec3f {
    return warped_in_cells(lattice, cells_from_world(lattice, world));
}

// The same for coordinates in cells that are not warped.
fn warped_in_cells(lattice: LatticeParams, coordinates: vec3f) -> vec3f {
    let cell = clamp(vec3i(floor(coordinates)), vec3i(0), vec3i(lattice.count) - 1);
    let low = wall_shifts_low(lattice, cell);
    let high = wall_shifts_high(lattice, cell);
    return vec3f(warped_axis(coordinates.x, cell.x, low.x, high.x),
        warped_axis(coordinates.y, cell.y, low.y, high.y), warped_axis(coordinates.z, cell.z, low.z, high.z));
}

// A cell as the warp has it, in cells that are not warped; for passes that ask for many of its points.
struct CellSpan { low: vec3f, side: vec3f }

fn cell_span(lattice: LatticeParams, cell: vec3u) -> CellSpan {
    let low = wall_shifts_low(lattice, vec3i(cell));
    return CellSpan(vec3f(cell) + low, 1.0 + wall_shifts_high(lattice, vec3i(cell)) - low);
}

// The world point of a point inside it.
fn point_in_span(lattice: LatticeParams, span: CellSpan, inside: vec3f) -> vec3f {
    return world_from_cells(lattice, span.low + inside * span.side);
}

// The inverse, for a point inside a cell (0..1 on each axis): cells that are not warped.
fn unwarped_coordinates(lattice: LatticeParams, cell: vec3u, inside: vec3f) -> vec3f {
    let span = cell_span(lattice, cell);
    return span.low + inside * span.side;
}

// The world point of that, m.
fn unwarped_point(lattice: LatticeParams, cell: vec3u, inside: vec3f) -> vec3f {
    return world_from_cells(lattice, unwarped_coordinates(lattice, cell, inside));
}

// 1 inside, falling to 0 towards the border, at a world point.
fn lattice_weight(lattice: LatticeParams, world: vec3f) -> f32 {
    let position = lattice_from_world(lattice, world);
    let inside = min((position - lattice.fade_low) / lattice.fade_low_width,
        (lattice.fade_high - position) / lattice.fade_high_width);
    return saturate(min(inside.x, min(inside.y, inside.z)));
}
