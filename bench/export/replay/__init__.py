"""The exported twin in MuJoCo alone, through the recorded motions, compared with the recorded currents."""
