// Rays from gather points towards what is bright of the environment, added to their sums.
//! use gather
//! use rays
//! use sky_cells
//! use tone
//! needs fn sky_passed(origin: vec3f, direction: vec3f) -> vec3f

const FARTHEST = 1e30;      // m

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= sky.reduced)) {
        return;
    }
    let start = textureLoad(starts, id.xy, 0);
    let n = textureLoad(normals, id.xy, 0).xyz;
    if (start.w <= 0.0) {
        return;
    }
    let origin = start.xyz;
    var sum = vec3f(0.0);
    var flux = vec3f(0.0);
    var squares = 0.0;
    var k = 0u;
    loop {
        if (k >= sky.sky_rays) { break; }
        // A direction chosen by brightness; what it counts, rays by the cosine know, too.
        let ray = sky_chosen(ray_numbers(id.x, id.y, sky.first_ray + k));
        let cosine = dot(ray.direction, n);
        if (cosine > 0.0) {
            if (!any_hit(origin, ray.direction, 0.0, FARTHEST)) {
                let share = sky_share(cosine, ray.density, sky.rays, sky.sky_rays);
                let found = share * sky_passed(origin, ray.direction) * ray.radiance;
                sum += found;
                flux += luminance(found) * flux_along(n, ray.direction);
                squares += luminance(found) * luminance(found);
            }
        }
        k++;
    }
    // Added to what rays by the cosine have found.
    let at = id.y * sky.reduced.x + id.x;
    sums[at].sky += sum;
    sums[at].sky_variance += squares;
    sums[at].sky_flux += flux;
}
