"""Is a robot folder fit to be identified: assembled, determined, regular, and the same to both libraries?

The model's geometry, in Pinocchio, is compared with MuJoCo's reading of the MJCF, masses included.
"""
