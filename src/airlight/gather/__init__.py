"""Final gather: a view's irradiance along rays, the lattices their cache of later bounces.

settings   what can be told of it
points     G-buffer -> places and normals at reduced resolution; point_params: their camera
orphans    more of them, on what no point of a block lies on
thinning   how many rays go on from segment to segment, and images of what they meet
trace      cosine-distributed rays from each, and the surfaces that they meet; albedo: of those
cells      the same from the cells of media, for what they scatter; seen_cells: from which
batches    as many rays as the device holds, and what they need
segments   their segments, traced and lit one after the other
paths      what their segments found; air: media along them; beams: light that goes forwards alone
calibration  how bright lattices' light is beside what paths trace
far        how long rays must be for their light to come from afar
sums       their light, lit as pixels are (lighting.hits), and what lies outside (sky_cells);
           found: the same without what single rays found by luck
later      what later segments bring, the mean of all paths that met the same place
guide      patches that lights shine on, from their maps; guided: rays towards them
sky        more rays towards what is bright outside
mirrors    rays of smooth surfaces' pixels, and what they mirror (mirror_passes, mirror_batches);
           glosses: of metal
history    the light of the frames before, looked up where points were then
solver     all of it in its order, batch by batch
filtering  the points' light shared between neighbours
upsample   and brought to pixels, turned to their own normals and near occluders
"""
