// Sums of one corner: covered share by side (+x -x +y -y +z -z), then per axis the covered share
// and its first moment about the face plane, all in fixed point.
const VALUES = 12u;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.surfel_count) {
        return;
    }
    let surfel = surfels[id.x];
    let instance = instances[surfel.instance];
    let world = (instance.world_from_object * vec4f(surfel.position, 1.0)).xyz;
    // The cofactor matrix takes area vectors to area vectors.
    let area = (instance.normal_from_object * vec4f(surfel.area_normal, 0.0)).xyz;
    let place = (world - params.origin) / params.cell;
    let corner = vec3i(floor(place + 0.5));
    if (any(corner < vec3i(0)) || any(corner > vec3i(params.count))) {
        return;
    }
    let offset = place - vec3f(corner);
    let c = vec3u(corner);
    let n = params.count + 1u;
    let first = VALUES * ((c.z * n.y + c.y) * n.x + c.x);
    let covered = area * (params.units / (params.cell * params.cell));
    for (var axis = 0u; axis < 3u; axis++) {
        let units = i32(round(abs(covered[axis])));
        if (units == 0) {
            continue;
        }
        let side = select(1u, 0u, covered[axis] > 0.0);
        atomicAdd(&sums[first + 2u * axis + side], units);
        if (surfel.is_two_sided != 0u) {
            atomicAdd(&sums[first + 2u * axis + 1u - side], units);
        }
        atomicAdd(&sums[first + 6u + axis], units);
        atomicAdd(&sums[first + 9u + axis], i32(round(f32(units) * offset[axis])));
    }
}
