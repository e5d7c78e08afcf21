"""The simulated machine: MuJoCo in closed loop, with hidden effects, sensors and known truth.

It shares no code with the identified model, so that an error in the model cannot confirm itself.
"""
