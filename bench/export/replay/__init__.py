"""The exported twin in MuJoCo alone, through the recorded motions, beside the recorded currents."""
