"""Surfaces: what the camera and the lights see of them, and how they are lit.

geometry     all meshes in shared buffers, drawn by material     textures    mip chains, upload
mesh_pass    the base of every pass over the meshes              gbuffer     what the camera sees
light_views  the projections of lights                           shadow      shadow maps
reflective   reflective shadow maps: what lights see             sky         environment -> lights
"""
