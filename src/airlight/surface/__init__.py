"""Surfaces as the camera and the lights see them.

   scene -> geometry      meshes in shared buffers: vertices, instances   textures   mip chains
               |          draws: by material, those in view
               |          mesh_pass: the base of every pass over them
               +-> gbuffer      depth, albedo, normal, emission of each pixel
               +-> shadow       depth of each light view                   light_views  projections
               +-> reflective   reflective shadow maps: virtual point lights
               +-> surfel_views peeled layers, for blockers from views
   environment -> sky           directional lights that stand for it
   lights -> light_table        all lights in one buffer
   lights -> light_maps         reflective shadow maps of all; coarse: of simplified scenes
   translucent -> panes         transmittance towards a light

materials: as shaders see them; draw_parts: what passes derive from a list of draws; hits: surfaces
that rays found, as a G-buffer has them.

On CPU adapters `visibility_buffer` draws triangle ids, which `triangle_table` and `packed_maps`
turn into surfaces, one pixel at a time; provoking: ids by the provoking vertex.
"""
