"""Rays against the triangles of a scene, on the device.

   sweep      where a hierarchy is divided     hierarchy  four children to a node, on the host
   cached     hierarchies cached on disk       words      nodes and triangles as shaders read them
   mesh_tree  of one mesh; of all that stand   masks      alpha of materials with holes
              still
   slots      what a pass binds                rays       RayScene: the textures to bind

`wgsl/rays.wgsl` has what a pass calls: `nearest_hit`, `any_hit`, `hit_point`.
"""
