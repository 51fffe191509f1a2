"""Lighting of surfaces by the fields that were solved, and what all solvers share.

kit            lights with shadow maps (lights), the sky (sky), the lattices: shared by solvers
surfaces       G-buffer -> emitted light -> occlusion -> lattice light -> direct, indirect
  lighting       the passes that add it up; kernel: what they are compiled from; slots: bound
  occlusion      screen-space occlusion and near-field radiance
  glossy         which materials trace mirrored rays; glossy_pixels: their list on CPU adapters
view           a camera's matrices and textures; accumulate: the mean of jittered images
translucent    layers of translucent surfaces, lit alike and put over each other
hidden         lights that closed opaque walls part from the eye are dark
hits           the same passes on surfaces that rays met; shadow_rays: where shadow maps are unsure
gathered       the field of a final gather, in place of lattices' light
read_layers    a drawn view as arrays
cascades       which lattices settings ask for; lattice_box: the box that they cover
reach          how far they go into a medium, and when a camera needs others
"""
