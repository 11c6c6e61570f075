"""People who move like people: planted feet, stiff links, minimum-jerk movements joined at rest.

What the bodies of all movements have in common; the movements are in `motion.movements`.

physique          lengths of a body, and the pose in which people stand at rest
minimum_jerk      S(x), and courses of angles from posture to posture
two_link          knees and elbows between ends that are known
pose, pelvis      axes of the trunk, the thirteen joints; hips at a height that legs can reach
arms              swung, or with hands that are somewhere
idle              sway, breath, pulse, fidgets: functions of the recording's time
planted           movements on planted feet, angles from the ankles up
stepping          steps to another stance, with inverse kinematics
boulic_thalmann, footsteps, lane, aids           parts of a gait
part, motion      what a movement is; a person who does one after another

Frame: x ahead, y left, z up from the floor; right before left wherever there are two. Arrays are
[3, joint, time], m; angles rad, flexion positive ahead.
"""
