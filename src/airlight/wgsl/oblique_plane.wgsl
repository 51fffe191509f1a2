// The plane of the oblique surfaces that a cell is near, by what is summed around corners.
//! use face_sums

const COVER = vec2f(0.25, 0.5);      // of the faces around a cell's middle, from which on a plane counts, and wholly
const SPREAD = vec2f(0.05, 0.15);   // cells, of surfaces around their plane: wholly flat, and none

// The sums of a side's oblique surfaces, as seen from a cell's middle.
struct ObliqueSums { normal: vec3f, moment: f32, square: f32 }

fn corner_sums(cell: vec3u, corner: vec3i, side: u32, sums: ObliqueSums) -> ObliqueSums {
    if (any(corner < vec3i(0)) || any(corner > vec3i(params.count))) {
        return sums;
    }
    let c = vec3u(corner);
    if ((u32(value(c, PLANE_SIDES)) & (1u << side)) == 0u) {
        return sums;
    }
    let at = PLANES + PLANE_VALUES * side;
    let n = vec3f(value(c, at), value(c, at + 1u), value(c, at + 2u)) / params.units;
    let moment = value(c, at + PLANE_MOMENT) / params.units;
    // From the cell's middle to the corner along the mean normal, and on to the surfaces.
    let area = length(n);
    let to_corner = dot(n, vec3f(corner) - vec3f(cell) - 0.5);
    let on = to_corner / max(area, 1e-6);
    return ObliqueSums(sums.normal + n, sums.moment + to_corner + moment, sums.square
        + on * to_corner + 2.0 * on * moment + value(c, at + PLANE_SQUARE) / params.units);
}

// xyz: the unit normal times how far the plane counts, 0 to 1; w: cells from it to the cell's middle.
fn fitted_plane(sums: ObliqueSums, side: u32) -> vec4f {
    let size = length(sums.normal);
    if (size < 0.1) {
        return vec4f(0.0);
    }
    let behind = sums.moment / size;
    let spread = sqrt(max(sums.square / size - behind * behind, 0.0));
    let covered = 0.25 * abs(sums.normal[side / 2u]);
    let counts = smoothstep(COVER.x, COVER.y, covered) * (1.0 - smoothstep(SPREAD.x, SPREAD.y, spread));
    return vec4f(sums.normal / size * counts, -behind);
}

// Of the surfaces that face one side, around the cell's own corners, or if these do not make a plane, around those of its
// neighbours on that axis, too.
fn plane_of_side(cell: vec3u, side: u32) -> vec4f {
    var sums = ObliqueSums(vec3f(0.0), 0.0, 0.0);
    for (var k = 0u; k < 8u; k++) {
        sums = corner_sums(cell, vec3i(cell + (vec3u(k, k >> 1u, k >> 2u) & vec3u(1u))), side, sums);
    }
    let own = fitted_plane(sums, side);
    if (dot(own, own) > 0.0 && length(own.xyz) > 0.99) {
        return own;
    }
    let axis = side / 2u;
    for (var k = 0u; k < 8u; k++) {
        var corner = vec3i(cell + (vec3u(k, k >> 1u, k >> 2u) & vec3u(1u)));
        corner[axis] += select(-1, 1, corner[axis] > i32(cell[axis]));
        sums = corner_sums(cell, corner, side, sums);
    }
    let wider = fitted_plane(sums, side);
    if (length(wider.xyz) > length(own.xyz)) {
        return wider;
    }
    return own;
}

// A board no thicker than this is thin, cells.
const THIN = 0.6;

// Whether two planes are the sides of something thin.
fn is_thin(front: vec4f, back: vec4f) -> bool {
    let sizes = length(front.xyz) * length(back.xyz);
    let thickness = -front.w - back.w;
    return sizes > 0.0 && dot(front.xyz, back.xyz) < -0.99 * sizes && abs(thickness) < THIN;
}

// How much of a face another wall may cover before a plane, and of how much on the plane counts no more.
const OTHER_WALL = vec2f(0.1, 0.3);
// Cells from a thin board to the middles of faces within which its own other side may be: sums hold what is half a cell from
// a corner, and faces have corners half a cell beside their middles.
const OWN_BACK = 1.1;
// Sines between a plane and an axis up to which walls across that are beside it.
const ACROSS = 0.2;

// How free of other walls the cells before a plane are, and those behind a thin board: in a narrow gap what is looked up
// before the plane would be beyond the other wall.
fn freedom(cell: vec3u, n: vec3f, w: f32, is_board: bool) -> f32 {
    var most = 0.0;
    for (var axis = 0u; axis < 3u; axis++) {
        if (abs(n[axis]) < ACROSS) {
            continue;
        }
        // The side of the axis that faces the plane from before it.
        let facing = 2u * axis + select(0u, 1u, n[axis] > 0.0);
        for (var o = -1; o < 3; o++) {
            var f = face_of(cell, 2u * axis + 1u);
            let place = i32(cell[axis]) + o;
            if (place < 0 || place > i32(params.count[axis])) {
                continue;
            }
            f.corner[axis] = u32(place);
            let distance = w + n[axis] * (f32(o) - 0.5);
            if (distance > select(0.0, OWN_BACK, is_board)) {
                most = max(most, on_face(f, facing));
            }
            if (is_board && distance < -OWN_BACK) {
                most = max(most, on_face(f, facing ^ 1u));
            }
        }
    }
    return 1.0 - smoothstep(OTHER_WALL.x, OTHER_WALL.y, most);
}

// The plane that a cell is nearest to, as fitted_plane, but by 2 longer where it is a side of a thin board; 0 where there is
// none.
fn oblique_plane(cell: vec3u) -> vec4f {
    var best = vec4f(0.0);
    var most = 0.0;
    var is_board = false;
    for (var axis = 0u; axis < 3u; axis++) {
        // Of the surfaces that face both ways along an axis: larger and nearer ones win.
        let high = plane_of_side(cell, 2u * axis);
        let low = plane_of_side(cell, 2u * axis + 1u);
        let of_high = length(high.xyz) / (1.0 + abs(high.w));
        let of_low = length(low.xyz) / (1.0 + abs(low.w));
        if (max(of_high, of_low) > most) {
            most = max(of_high, of_low);
            best = select(low, high, of_high >= of_low);
            is_board = is_thin(high, low);
        }
    }
    if (most == 0.0) {
        return best;
    }
    // In narrow gaps it counts less, as what lies before it may be beyond another wall.
    let size = length(best.xyz);
    let n = best.xyz / size;
    let counts = size * freedom(cell, n, best.w, is_board);
    return vec4f(n * select(counts, counts + 2.0, is_board && counts > 0.0), best.w);
}
