//! use view_texel

const GRAZING = 0.1;    // the least cosine: texels there stand for more than they show

fn add(index: u32, value: f32) {
    let units = i32(round(value * params.units));
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
    // Half a cell beside the lattice: around its corners.
    let corner = vec3i(floor((world - params.origin) / params.cell + 0.5));
    if (any(corner < vec3i(0)) || any(corner > vec3i(params.count))) {
        return;
    }
    let c = vec3u(corner);
    let size = params.count + 1u;
    let first = 5u * ((c.z * size.y + c.y) * size.x + c.x);
    let share = surfel_area(view, world, n, centre) / (params.cell * params.cell);
    add(first, 0.25 * share);
    add(first + 1u, 0.5 * share * n.x);
    add(first + 2u, 0.5 * share * n.y);
    add(first + 3u, 0.5 * share * n.z);
    // One reflectance for all channels, as the paper has it.
    let rgb = textureLoad(reflectance, vec2i(id.xy), layer, 0).rgb;
    add(first + 4u, 0.25 * share * dot(rgb, vec3f(0.2126, 0.7152, 0.0722)));
}
