"""The simulated machine: MuJoCo in closed loop, its hidden effects, its sensors, and the truth about them.

Nothing in this room is shared with the model that is identified, so that the bench cannot confirm its mistake.
"""
