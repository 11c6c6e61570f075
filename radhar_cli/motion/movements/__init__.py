"""The movements of people, a family a file: keys, words, states, usual duration and physics.

A module here may have three names that `catalogue` looks for:

SECTION     class of the section `motion.NAME` of a config, where NAME is that of the module
TIMING      class of its keys of `timing`, which says when movements of the twelve classes begin
MOVEMENTS   `kind.MovementKind` of each movement: what it is called and how it is made of the keys

A further file makes its keys, its classes, its columns of data sets and its page of docs known.
What bodies have in common (pose, pelvis, planted feet, minimum jerk) is in `motion.human`.
"""
