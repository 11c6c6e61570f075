"""The kinematics of the paper: raised-cosine phases and sinusoidal swings."""
