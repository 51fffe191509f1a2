// The environment as cells of even radiance, each as often chosen as it is bright. The including pass binds `sky_cells`
// (gather/sky.py) and declares `sky` with their counts and the map's rotation.

const SKY_PI = 3.14159265;

struct SkyRay {
    direction: vec3f,
    radiance: vec3f,    // W m^-2 sr^-1
    density: f32,       // sr^-1, of rays that are sent there
}

fn sky_cell(index: u32, direction: vec3f) -> SkyRay {
    let cell = sky_cells[2u * index];
    return SkyRay(direction, cell.rgb, cell.a);
}

// What lies in a direction.
fn sky_along(direction: vec3f) -> SkyRay {
    let turn = (atan2(direction.x, -direction.z) + sky.rotation) / (2.0 * SKY_PI);
    let v = acos(clamp(direction.y, -1.0, 1.0)) / SKY_PI;
    let size = vec2f(f32(sky.width), f32(sky.height));
    let at = min(vec2u(vec2f(fract(turn), v) * size), vec2u(sky.width, sky.height) - 1u);
    return sky_cell(at.y * sky.width + at.x, direction);
}

// A direction by brightness: a cell of the alias table, and within it evenly over its solid angle.
fn sky_chosen(numbers: vec2f) -> SkyRay {
    let count = sky.width * sky.height;
    let place = numbers.x * f32(count);
    var index = min(u32(place), count - 1u);
    let alias_row = sky_cells[2u * index + 1u];
    let within = place - f32(index);
    let is_kept = within < alias_row.x;
    // The rest of the number is uniform again.
    var along = within / max(alias_row.x, 1e-9);
    if (!is_kept) {
        along = (within - alias_row.x) / max(1.0 - alias_row.x, 1e-9);
        index = u32(alias_row.y);
    }
    // Within the cell even in longitude and in height, which is even in solid angle.
    let column = f32(index % sky.width);
    let row = f32(index / sky.width);
    let phi = 2.0 * SKY_PI * (column + along) / f32(sky.width) - sky.rotation;
    let top = cos(SKY_PI * row / f32(sky.height));
    let low = cos(SKY_PI * (row + 1.0) / f32(sky.height));
    let y = mix(top, low, numbers.y);
    let flat = sqrt(max(1.0 - y * y, 0.0));
    return sky_cell(index, vec3f(flat * sin(phi), y, -flat * cos(phi)));
}
