"""Point clouds as TI's 3D people tracking firmware makes them, a step a file.

`spectrum`: range bins, decoded and without static echoes. `grid`: directions that are looked
at. `capon`: covariance, map of power over directions, weights. `two_pass_cfar`: which cells of the
map are points. `refinement`: elevation, or zoom. `static`: static points. `fine_motion`: frames
seen together. `chain`: all of it, for a frame and for a cube.
"""
