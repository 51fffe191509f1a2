"""Rays against the triangles of a scene, on the device.

   sweep      where a hierarchy is divided     hierarchy  four children to a node, on the host
   cached     hierarchies cached on disk       words      nodes and triangles as shaders read them
   mesh_tree  of one mesh; of all that stand   masks      alpha of materials with holes
              still
   rays       RayScene: what a pass binds

A pass calls `nearest_hit` and `any_hit` of `wgsl/rays.wgsl`, and `hit_point` of
`wgsl/ray_surface.wgsl`.
"""
