//! use view_texel
//! use blocker_sums

const GRAZING = 0.1;    // the least cosine: texels there stand for more than they show

fn add(index: u32, units: i32) {
    if (units != 0) { atomicAdd(&sums[index], units); }
}

// The area of the surface that a texel shows.
fn surfel_area(view: LightViewData, world: vec3f, n: vec3f, centre: vec2f) -> f32 {
    let towards = view_direction(view, world, centre);
    var across = view_texel_measure(view, centre, params.resolution);
    if (view.is_perspective != 0u) {
        let reach = world - view_eye(view);
        across *= dot(reach, reach);
    }
    return across / max(abs(dot(n, towards)), GRAZING);
}

fn add_axis(first: u32, axis: u32, covered: f32, offset: f32, reflectance: vec3f) {
    let units = i32(round(abs(covered)));
    if (units == 0) {
        return;
    }
    let side = 2u * axis + select(1u, 0u, covered > 0.0);
    add(first + side, units);
    add(first + AXIS_COVER + axis, units);
    add(first + AXIS_MOMENT + axis, i32(round(f32(units) * offset)));
    let outward = select(-offset, offset, covered > 0.0);
    atomicMax(&sums[first + SIDE_BEHIND + side], behind_code(outward));
    let reflected = vec3i(round(f32(units) * reflectance));
    for (var channel = 0u; channel < 3u; channel++) {
        add(first + SIDE_REFLECTED + 3u * side + channel, reflected[channel]);
    }
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(params.resolution))) {
        return;
    }
    let layer = params.first_layer + id.z;
    let d = textureLoad(depth, vec2i(id.xy), layer, 0);
    if (d >= 1.0) {
        return;
    }
    let view = views[params.view];
    let centre = (vec2f(id.xy) + 0.5) / f32(params.resolution) * vec2f(2.0, -2.0)
        + vec2f(-1.0, 1.0);
    let clip = view.world_from_clip * vec4f(centre, d, 1.0);
    let world = clip.xyz / clip.w;
    let n = normalize(textureLoad(normal, vec2i(id.xy), layer, 0).xyz);
    let place = (world - params.origin) / params.cell;
    let corner = vec3i(floor(place + 0.5));
    if (any(corner < vec3i(0)) || any(corner > vec3i(params.count))) {
        return;
    }
    let offset = place - vec3f(corner);
    let c = vec3u(corner);
    let size = params.count + 1u;
    let first = CORNER_VALUES * ((c.z * size.y + c.y) * size.x + c.x);
    let share = surfel_area(view, world, n, centre) / (params.cell * params.cell);
    let covered = n * (share * params.units);
    let rgb = textureLoad(reflectance, vec2i(id.xy), layer, 0).rgb;
    add_axis(first, 0u, covered.x, offset.x, rgb);
    add_axis(first, 1u, covered.y, offset.y, rgb);
    add_axis(first, 2u, covered.z, offset.z, rgb);
}
