// A cell's light on cells half as wide, by cubic splines through the cells that hold some; no brighter and no darker
// than the eight around it. See maths/halved_cells.py.
//! use medium_grid
//! use walls
//! use octants

// Catmull and Rom's weights of four cells, t beyond the second one.
fn spline(t: f32) -> vec4f {
    let s = 1.0 - t;
    return 0.5 * vec4f(-t * s * s, 2.0 + t * t * (3.0 * t - 5.0),
        t * (1.0 + t * (4.0 - 3.0 * t)), -t * t * s);
}

// How far behind the middle of a cell the surface between it and the next one is, in cells.
fn wall_position(cell: vec3u, axis: u32) -> f32 {
    return f32(position_of(walls[2u * cell_index(cell)] >> WALL_POSITIONS, axis)) / f32(WALL_FREE - 1u);
}

// The cell on whose side of all surfaces the middle of a half cell lies: that which it is in, or one beside it.
fn home_of(id: vec3u) -> vec3u {
    let inside = id / 2u;
    let faces = walls[2u * cell_index(inside)];
    var home = inside;
    for (var axis = 0u; axis < 3u; axis++) {
        let side = id[axis] & 1u;
        // Only a surface on the half cell's own side can lie before its middle.
        if (!is_walled(faces, axis, side)) {
            continue;
        }
        var below = inside;
        below[axis] -= 1u - side;
        // That middle is a quarter of a cell off the cell's: nearer surfaces are before it.
        let position = wall_position(below, axis);
        if (select(position > 0.75, position < 0.25, side == 1u)) {
            home[axis] = select(home[axis] - 1u, home[axis] + 1u, side == 1u);
        }
    }
    return home;
}

// Whether no surface stands on the path to a cell that is at most one away along each axis, which goes along one axis
// after the other, in this order.
fn is_open_along(begin: vec3u, end: vec3u, axes: vec3u) -> bool {
    var at = begin;
    for (var k = 0u; k < 3u; k++) {
        let axis = axes[k];
        if (at[axis] != end[axis]) {
            if (is_walled(walls[2u * cell_index(at)], axis, u32(end[axis] > at[axis]))) {
                return false;
            }
            at[axis] = end[axis];
        }
    }
    return true;
}

// Trilinear light of those of the eight cells around the middle of a half cell that lie on its side of all surfaces.
fn walled_light(id: vec3u) -> vec3f {
    let at = 0.5 * vec3f(id) - 0.25;
    let first = vec3i(floor(at));
    let t = at - floor(at);
    let last = vec3i(params.count) - 1;
    // The eight coarse cells around the finer one, by trilinear shares, where no wall lies between.
    let home = home_of(id);
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let corner = octant(k);
        let cell = vec3u(clamp(first + vec3i(corner), vec3i(0), last));
        let is_open = is_open_along(home, cell, vec3u(0u, 1u, 2u)) || is_open_along(home, cell, vec3u(2u, 1u, 0u));
        if (reach[cell_index(cell)] == 0u || !is_open) {
            continue;
        }
        let share = mix(1.0 - t, t, vec3f(corner));
        let weight = max(share.x * share.y * share.z, 1e-4);
        sum += weight * textureLoad(emission, cell, 0).rgb;
        total += weight;
    }
    return sum / max(total, 1e-4);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= 2u * params.count)) {
        return;
    }
    // Where no light is needed none is read.
    let inside = id / 2u;
    if (reach[cell_index(inside)] == 0u) {
        textureStore(halved, id, vec4f(0.0));
        return;
    }
    // Where surfaces stand between cells none is read behind them.
    if ((walls[2u * cell_index(inside)] & WALLS_NEAR) != 0u) {
        textureStore(halved, id, vec4f(walled_light(id), 1.0));
        return;
    }
    // Catmull-Rom splines over 64 cells; those that hold no light are missing from the sum.
    let at = 0.5 * vec3f(id) - 0.25;
    let first = vec3i(floor(at)) - 1;
    let t = at - floor(at);
    let x = spline(t.x);
    let y = spline(t.y);
    let z = spline(t.z);
    let last = vec3i(params.count) - 1;
    var sum = vec3f(0.0);
    var total = 0.0;
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    for (var k = 0u; k < 64u; k++) {
        let corner = vec3u(k & 3u, (k >> 2u) & 3u, k >> 4u);
        let cell = vec3u(clamp(first + vec3i(corner), vec3i(0), last));
        if (reach[cell_index(cell)] == 0u) {
            continue;
        }
        let light = textureLoad(emission, cell, 0).rgb;
        let weight = x[corner.x] * y[corner.y] * z[corner.z];
        sum += weight * light;
        total += weight;
        if (all((corner == vec3u(1u)) | (corner == vec3u(2u)))) {
            least = min(least, light);
            most = max(most, light);
        }
    }
    // The cell itself is among the eight.
    textureStore(halved, id, vec4f(clamp(sum / max(total, LEAST_TOTAL), least, most), 1.0));
}

// Weights of cells without light are missing; the rest counts as at least so much.
const LEAST_TOTAL = 0.1;
