"""Motion from files: readers of BVH, ASF/AMC and npz, the thirteen joints in them, how they move.

bytes -> Recording (joints over frames) -> Clip (thirteen joints, m) -> FileMotion
"""
