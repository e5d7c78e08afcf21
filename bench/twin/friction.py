"""How MuJoCo is to hold dry friction."""

STEPS_TO_STICK = 4.0  # time steps in which it stops a joint: MuJoCo's default of 20 ms lets it creep
STIFF = [0.99, 0.999, 1e-4, 0.5, 2.0]
