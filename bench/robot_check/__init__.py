"""Whether a robot folder is fit for identification: assembled, determined, regular, and read alike by both libraries.

The model's geometry, in Pinocchio, is compared with MuJoCo's reading of the MJCF, masses included.
"""
