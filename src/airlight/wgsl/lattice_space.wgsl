// Where a world point is among the cells. The including pass binds lattice_walls (how far the walls
// on each cell's low faces really lie from them, in cells) and declares the struct LatticeParams.
//
// Blockers round walls to cell faces; up to half a cell before or behind a wall would then belong
// to a cell on its other side. So space is bent: a piecewise linear map per axis takes every wall
// to the face it was rounded to.

// A cell's place in the textures, which nested lattices share.
fn lattice_texel(lattice: LatticeParams, cell: vec3i) -> vec3i {
    return cell + vec3i(0, i32(lattice.first_row), 0);
}

fn wall_shifts_low(lattice: LatticeParams, cell: vec3i) -> vec3f {
    return textureLoad(lattice_walls, lattice_texel(lattice, cell), 0).xyz;
}

fn wall_shifts_high(lattice: LatticeParams, cell: vec3i) -> vec3f {
    let last = vec3i(lattice.count) - 1;
    let next = min(cell + 1, last);
    let shifts = vec3f(wall_shifts_low(lattice, vec3i(next.x, cell.yz)).x,
        wall_shifts_low(lattice, vec3i(cell.x, next.y, cell.z)).y,
        wall_shifts_low(lattice, vec3i(cell.xy, next.z)).z);
    return select(shifts, vec3f(0.0), cell == last);
}

// Cells from the lattice's origin to bent cells.
fn bent_place(lattice: LatticeParams, world: vec3f) -> vec3f {
    let place = (world - lattice.origin) / lattice.cell;
    let cell = clamp(vec3i(floor(place)), vec3i(0), vec3i(lattice.count) - 1);
    let low = wall_shifts_low(lattice, cell);
    let high = wall_shifts_high(lattice, cell);
    let t = place - vec3f(cell);
    let between = (t - low) / max(1.0 + high - low, vec3f(0.25));
    let below = (t - low) / (1.0 + low);
    let above = 1.0 + (t - 1.0 - high) / (1.0 - high);
    let bent = select(select(between, above, t > 1.0 + high), below, t < low);
    return vec3f(cell) + bent;
}

// The world point of a place inside a cell (0..1 on each axis), the other way round.
fn unbent_point(lattice: LatticeParams, cell: vec3u, inside: vec3f) -> vec3f {
    let low = wall_shifts_low(lattice, vec3i(cell));
    let high = wall_shifts_high(lattice, vec3i(cell));
    let place = vec3f(cell) + low + inside * (1.0 + high - low);
    return lattice.origin + place * lattice.cell;
}

// 1 inside, falling to 0 towards the border.
fn lattice_weight(lattice: LatticeParams, position: vec3f) -> f32 {
    let inside = min((position - lattice.fade_low) / lattice.fade_low_width,
        (lattice.fade_high - position) / lattice.fade_high_width);
    return saturate(min(inside.x, min(inside.y, inside.z)));
}
