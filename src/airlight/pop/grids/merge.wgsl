// The light of all grids in a cell of the medium (Elek2014 section 5.3), and the residuum there.
//! use hop_grid
//! use medium_grid
//! use octants

// What a grid holds at a point, weighted.
struct GridLight {
    weight: f32,
    seen: vec3f,        // in-scattered radiance
    residual: vec3f,    // W m^-3 per density
    carried: vec3f,     // of that, the net power along the grid's light
}

// A cell of a shell's square, or the cell that the seams of the octahedron put on the rim around
// it.
fn across_seam(n: u32, at: vec2i) -> vec2u {
    let side = i32(grids[n].count.x);
    let inside = clamp(at, vec2i(0), vec2i(side - 1));
    let over = at - inside;
    let step = select(over, vec2i(over.x, 0), over.x != 0);
    return vec2u(octahedron_neighbour(inside, step, side));
}

// Trilinear and weighted by density, so that empty cells do not count.
fn read_grid(n: u32, coordinates: vec3f) -> GridLight {
    var sum = GridLight(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
    let g = grids[n];
    let is_radial = g.is_radial == 1u;
    let top = vec3f(g.count) - 1.0;
    var at = clamp(coordinates - 0.5, vec3f(0.0), top);
    if (is_radial) {
        at = vec3f(coordinates.xy - 0.5, at.z);
    }
    // The eight cells around the point, by how near and how dense they are; a radial grid's rows close to a ring.
    let low = floor(at);
    let part = at - low;
    for (var k = 0u; k < 8u; k++) {
        let upper = octant(k);
        let share = select(1.0 - part, part, upper == vec3u(1u));
        var cell = vec3u(min(vec3f(low) + vec3f(upper), top));
        if (is_radial) {
            cell = vec3u(across_seam(n, vec2i(low.xy) + vec2i(upper.xy)), cell.z);
        }
        let index = hop_index(n, cell);
        let rho = max(hop_rho[n * hops.capacity + index], 0.0);
        let w = share.x * share.y * share.z * rho;
        if (w <= 0.0) {
            continue;
        }
        // What is seen of a cell, and per volume what it has left and carries.
        let slot = 3u * (n * hops.capacity + index);
        let density = w / (rho * hop_volume(n, cell));
        sum.weight += w;
        sum.seen += w * gathered[slot].xyz;
        if (!is_radial) {
            sum.residual += density * gathered[slot + 1u].xyz;
            sum.carried += density * gathered[slot + 2u].xyz;
        }
    }
    return sum;
}

// Write a deposit, or add it to that of beams.
fn deposit(slot: u32, more: vec3f) {
    deposits[slot] = select(vec4f(0.0), deposits[slot], hops.is_added == 1u) + vec4f(more, 0.0);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells) {
        return;
    }
    // Sums over all grids that hold light.
    let rho = density[id.x];
    let point = cell_centre(cell_of(id.x));
    var seen = vec3f(0.0);
    var power = vec3f(0.0);
    var forward = array<vec3f, 3>(vec3f(0.0), vec3f(0.0), vec3f(0.0));
    for (var n = 0u; n < hops.grids; n++) {
        if (hop_cells(n) == 0u) {
            continue;
        }
        let got = read_grid(n, hop_place(n, point));
        if (got.weight <= 0.0) {
            continue;
        }
        seen += got.seen / got.weight;
        power += got.residual / got.weight;
        let d = grids[n].axis_z;
        for (var axis = 0u; axis < 3u; axis++) {
            forward[axis] += got.carried / got.weight * d[axis];
        }
    }
    // Residuum per density, times the medium in the cell; around local lights it was summed in
    // fixed point, and the sums are cleared.
    let fill = rho * params.cell.x * params.cell.y * params.cell.z;
    merged[id.x] = vec4f(seen, 0.0);
    var splat = vec3f(0.0);
    for (var c = 0u; c < 3u; c++) {
        splat[c] = f32(atomicExchange(&splatted[3u * id.x + c], 0)) / max(grids[0].fixed_scale, 1e-30);
    }
    deposit(id.x, fill * power + splat);
    for (var axis = 0u; axis < 3u; axis++) {
        deposit(id.x + (1u + axis) * params.cells, fill * forward[axis]);
    }
}
