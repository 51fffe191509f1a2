//! use octahedron
//! use cell_order

// Grids that light hops in; see maths/ordinate_grid.py and maths/radial_grid.py. The including pass
// binds `params` (MediumParams), `grids` (HopGridData) and `solid_angles` (array<f32>, of the cells
// of a shell).

fn hop_cell(n: u32, index: u32) -> vec3u {
    return cell_at_index(grids[n].count, index);
}

fn hop_index(n: u32, cell: vec3u) -> u32 {
    return cell_in(grids[n].count, cell);
}

fn hop_cells(n: u32) -> u32 {
    let c = grids[n].count;
    return c.x * c.y * c.z;
}

// Radius of a shell's inner edge, m.
fn shell_edge(n: u32, shell: u32) -> f32 {
    let g = grids[n];
    let out = f32(i32(shell) - i32(g.count.z));
    return select(g.radius * pow(g.growth, out), 0.0, shell == 0u);
}

fn hop_path(n: u32, z: u32) -> f32 {
    if (grids[n].is_radial == 0u) {
        return grids[n].cell;
    }
    return shell_edge(n, z + 1u) - shell_edge(n, z);
}

fn shell_radius(n: u32, z: u32) -> f32 {
    return 0.5 * (shell_edge(n, z + 1u) + shell_edge(n, z));
}

fn hop_volume(n: u32, cell: vec3u) -> f32 {
    let g = grids[n];
    if (g.is_radial == 0u) {
        return g.cell * g.cell * g.cell;
    }
    let r0 = shell_edge(n, cell.z);
    let r1 = shell_edge(n, cell.z + 1u);
    return solid_angles[cell.y * g.count.x + cell.x] * (r1 * r1 * r1 - r0 * r0 * r0) / 3.0;
}

// From coordinates in cells from the grid's corner to a point in the medium's frame. Inside a shell, r is
// linear.
fn hop_point(n: u32, coordinates: vec3f) -> vec3f {
    let g = grids[n];
    if (g.is_radial == 0u) {
        let at = g.cell * coordinates;
        return g.corner + at.x * g.axis_x + at.y * g.axis_y + at.z * g.axis_z;
    }
    let shell = u32(coordinates.z);
    let r = mix(shell_edge(n, shell), shell_edge(n, shell + 1u), fract(coordinates.z));
    return g.corner + r * octahedron_decode(2.0 * coordinates.xy / f32(g.count.x) - 1.0);
}

// The inverse; shells by the logarithm of r outside the innermost one.
fn hop_place(n: u32, point: vec3f) -> vec3f {
    let g = grids[n];
    let away = point - g.corner;
    if (g.is_radial == 0u) {
        return vec3f(dot(away, g.axis_x), dot(away, g.axis_y), dot(away, g.axis_z)) / g.cell;
    }
    let r = max(length(away), 1e-9 * g.radius);
    let direction = select(vec3f(0.0, 0.0, 1.0), away, r > 1e-8 * g.radius);
    let square = (octahedron_encode(direction) + 1.0) * (0.5 * f32(g.count.x));
    let inner = shell_edge(n, 1u);
    let outside = 1.0 + log(max(r / inner, 1.0)) / log(g.growth);
    return vec3f(square, select(outside, r / inner, r < inner));
}

// Direction of travel of a grid's light at a point of the medium.
fn hop_travel(n: u32, point: vec3f) -> vec3f {
    let g = grids[n];
    if (g.is_radial == 0u) {
        return g.axis_z;
    }
    return normalize(point - g.corner + vec3f(1e-12));
}

// The neighbour to the side (-x, +x, -y, +y), as a cell; z is 0xffffffff where there is none.
fn hop_beside(n: u32, cell: vec3u, side: u32) -> vec3u {
    let g = grids[n];
    let step = select(vec2i(-1, 0), vec2i(1, 0), (side & 1u) == 1u);
    let at = vec2i(cell.xy);
    let turned = select(step, step.yx, side >= 2u);
    if (g.is_radial == 1u) {
        return vec3u(vec2u(octahedron_neighbour(at, turned, i32(g.count.x))), cell.z);
    }
    let other = at + turned;
    let outside = any(other < vec2i(0)) || any(other >= vec2i(g.count.xy));
    return select(vec3u(vec2u(other), cell.z), vec3u(0xffffffffu), outside);
}

// Share of the light that a cell sends to a side which that neighbour takes; the rest stays.
fn hop_side_gain(n: u32, from_cell: vec3u, to_cell: vec3u) -> f32 {
    let g = grids[n];
    if (g.is_radial == 0u) {
        return 1.0;
    }
    let source = solid_angles[from_cell.y * g.count.x + from_cell.x];
    let taker = solid_angles[to_cell.y * g.count.x + to_cell.x];
    return 2.0 * taker / (source + taker);
}
