// Cells with a point that light of the sky reaches through a box whose medium changed, or with one in such a box.
//! use lattice_space
//! use map_visibility
//! use octants
//! use wider_box
//! use cell_order

const FAR = 3.0e38;
const MARGIN = 1e-3;    // cells, whatever rounding makes of a path along the side of a box

// Whether any part of light i arrives at p.
fn is_lit(world: vec3f, i: u32) -> bool {
    let clip = row_of_views(i).clip_from_world * vec4f(world, 1.0);
    return map_visibility(depth, compare, i, map_coordinates(clip.xyz)) > 0.0;
}

// Whether the path from anywhere in a ball about p meets a box; `towards` 0: whether the ball does.
fn meets(from_world: mat4x4f, p: vec3f, towards: vec3f, radius: f32) -> bool {
    let axes = mat3x3f(from_world[0].xyz, from_world[1].xyz, from_world[2].xyz);
    let across = transpose(axes);
    let half = radius * vec3f(length(across[0]), length(across[1]), length(across[2]));
    return meets_wider_box(axes * p + from_world[3].xyz, axes * towards, FAR, half);
}

// Whether a ray is, anywhere, within `reach` of a point that is `away` from its origin; m.
fn comes_near(away: vec3f, towards: vec3f, reach: f32) -> bool {
    let beside = away - max(dot(away, towards), 0.0) * towards;
    return dot(beside, beside) <= reach * reach;
}

// One of the eight points of a cell at which passes look for light.
fn point_of(span: CellSpan, k: u32) -> vec3f {
    return point_in_span(lattice, span, octant_middle(k));
}

// Whether one of them is in a box, lit or not: light is averaged over those that are in media.
fn has_point_in(span: CellSpan, from_world: mat4x4f) -> bool {
    for (var k = 0u; k < 8u; k++) {
        if (meets(from_world, point_of(span, k), vec3f(0.0), MARGIN * lattice.cell)) {
            return true;
        }
    }
    return false;
}

// Whether light i reaches one of them through a box.
fn is_touched(span: CellSpan, i: u32, from_world: mat4x4f) -> bool {
    for (var k = 0u; k < 8u; k++) {
        let p = point_of(span, k);
        if (meets(from_world, p, -row_of_lights(i).direction, MARGIN * lattice.cell) && is_lit(p, i)) {
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    // All its points lie in a ball, which few paths through a box meet.
    let span = cell_span(lattice, id);
    let centre = point_in_span(lattice, span, vec3f(0.5));
    let radius = (0.25 * length(span.side) + MARGIN) * lattice.cell;
    var is_stale = false;
    for (var b = 0u; b < params.boxes && !is_stale; b++) {
        // A cell is stale where a point of it lies in a box, or has one between itself and a light.
        let from_world = boxes[b].volume_from_world;
        let away = boxes[b].centre - centre;
        let reach = boxes[b].radius + radius;
        if (dot(away, away) <= reach * reach && meets(from_world, centre, vec3f(0.0), radius)) {
            is_stale = has_point_in(span, from_world);
        }
        for (var i = 0u; i < params.light_count && !is_stale; i++) {
            let towards = -row_of_lights(i).direction;
            if (comes_near(away, towards, reach) && meets(from_world, centre, towards, radius)) {
                is_stale = is_touched(span, i, from_world);
            }
        }
    }
    if (is_stale) {
        let n = atomicAdd(&stale_cells[0], 1u);
        atomicStore(&stale_cells[n + 1u], cell_in(lattice.count, id));
    }
}
