"""The formulas of the package as NumPy float64 truths; no GPU, nothing else of the package.

   light       sh, phase, reflection, solid_angle, area_light, light_sizes, occlusion, sampling,
               gather, gather_history, gather_orphans, gather_turning, light_guide, ggx_sampling,
               translucency, cosines_fit (of area_light's table)
   sky         sun_position, sunlight, atmosphere; blackbody, observer, spectra: as colours
   lattices    lattice6 (Kaplanyan2010); lattice26, lattice26_walls, regions
               (Billeter2012); flat_surfaces: before which light enters farther
   ordinates   ordinates, view_ordinates, view_importance: which; ordinate_grid, ordinate_hops,
               radial_grid: propagation; delta_beam, outgoing_light, point_light_beam, diffusion:
               beams (Elek2014); nested_diffusion: on finer grids; halved_cells: light between cells
   media       medium, mixtures, two_streams, voxels, empty_voxels, solid_voxels, half_space,
               forward_phase, forward_beams, air_lobes, sky_phase, beam_phase
   space       transforms, octahedron, latlong, weld, level_set, closing, keyframes; rays, box_tree
   numbers     colour, tone, lut, half, tangent_angle, chunks; arrays: their types

Where a shader needs the same formula, a WGSL function of the same name, its twin, stands in
`wgsl/`, and a test holds the two together.
"""
