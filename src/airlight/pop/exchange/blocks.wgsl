// One block of a sending medium: the power that its part outside the receiver's box scatters, W,
// and its net flux. The position of a block does not depend on light.
//! use medium_grid
//! use ordinate_kind
//! needs fn leaving_beams(cell: u32) -> vec3f
//! needs fn leaving_forward(cell: u32) -> vec3f
//! needs fn scattering_own(cell: u32) -> vec3f
//! needs fn mass_own(cell: u32) -> f32

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= BLOCKS_PER_AXIS * BLOCKS_PER_AXIS * BLOCKS_PER_AXIS) {
        return;
    }
    // The cells of the block.
    let at = cell_at_index(vec3u(BLOCKS_PER_AXIS), id.x);
    let low = at * params.count / BLOCKS_PER_AXIS;
    let high = (at + 1u) * params.count / BLOCKS_PER_AXIS;
    let volume = params.cell.x * params.cell.y * params.cell.z;
    // Sums over them: power, its net flux, centre of mass, optical depth.
    var power = vec3f(0.0);
    var moment = array<vec3f, 3>(vec3f(0.0), vec3f(0.0), vec3f(0.0));
    var position = vec3f(0.0);
    var weight = 0.0;
    var depth = vec3f(0.0);
    var filled = 0.0;
    for (var z = low.z; z < high.z; z++) {
        for (var y = low.y; y < high.y; y++) {
            for (var x = low.x; x < high.x; x++) {
                // Empty cells send nothing, and cells in the receiver's box are its own.
                let cell = cell_index(vec3u(x, y, z));
                let point = cell_centre(vec3u(x, y, z));
                let uvw = (receiver.uvw_from_sender * vec4f(point, 1.0)).xyz;
                let rho = mass_own(cell);
                if (rho <= 0.0 || (all(uvw > vec3f(0.0)) && all(uvw < vec3f(1.0)))) {
                    continue;
                }
                // Of what leaves beams the medium's own share, and its diffuse light, scattered.
                let own = scattering_own(cell);
                let forward = own * row_of_media(0).g;
                let share = own / max(leaving_beams(cell), vec3f(1e-20));
                let all_forward = leaving_forward(cell);
                let has = abs(all_forward) > 1e-3 * abs(forward);
                let turned = select(vec3f(0.0), forward / select(vec3f(1.0), all_forward, has), has);
                power += share * deposits[cell].xyz + volume * own * diffuse[cell].xyz;
                for (var axis = 0u; axis < 3u; axis++) {
                    let index = (axis + 1u) * params.cells + cell;
                    moment[axis] += turned * deposits[index].xyz
                        + volume * forward * diffuse[index].xyz;
                }
                // Centre of mass, and the optical depth per metre, weighted by density.
                position += rho * point;
                weight += rho;
                filled += 1.0;
                for (var m = 0u; m < MEDIA; m++) {
                    depth += rho * density[m * params.cells + cell] * row_of_media(m).sigma_t;
                }
            }
        }
    }
    // The block as an ordinate of the receiver.
    let row = receiver.first_row + id.x;
    let local = select(0.5 * params.extent, position / weight, weight > 0.0);
    ordinates[row].position =
        vec4f((receiver.receiver_from_sender * vec4f(local, 1.0)).xyz, BLOCK);
    // Its power, squared rms radius (of a sphere of its volume, per axis), net flux and depth.
    let units = receiver.scale;
    let radius = pow(0.2387 * max(filled, 1.0) * volume, 1.0 / 3.0);
    let side = pow(max(filled, 1.0) * volume, 1.0 / 3.0);
    let first = 5u * (receiver.first + id.x);
    blocks[first] = vec4f(units * power, radius * radius / 3.0);
    let turn = receiver.receiver_from_sender;
    for (var axis = 0u; axis < 3u; axis++) {
        blocks[first + 1u + axis] = vec4f(units * (turn[0][axis] * moment[0]
            + turn[1][axis] * moment[1] + turn[2][axis] * moment[2]), 0.0);
    }
    blocks[first + 4u] = vec4f(side * depth / max(weight, 1e-20), 0.0);
}
