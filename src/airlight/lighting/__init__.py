"""Lighting of surfaces by the fields that were solved, and what all solvers share.

kit            lights with shadow maps (lights), the sky (sky), the lattices: shared by solvers
surfaces       G-buffer -> emitted light -> occlusion -> lattice light -> direct, indirect
  lighting       the pass that adds it up; kernel: what its variants are compiled from
  occlusion      screen-space occlusion and near-field radiance
  glossy         which materials trace mirrored rays; glossy_pixels: their list on CPU adapters
view           a camera's matrices and textures; accumulate: the mean of jittered images
read_layers    a drawn view as arrays
lattice_box    the box that lattices cover
"""
