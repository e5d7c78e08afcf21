# ---
# jupyter: {jupytext: {text_representation: {extension: .py, format_name: percent}}}
# ---

# %% [markdown]
# # An effect of your own
# Write the law, let it compete with the catalogue, and see how much it improves the model.

# %%
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import bench

# %% [markdown]
# ## Measurements
# A five-bar with friction that grows with the acceleration, which no effect of the catalogue models.

# %%
SCENARIO = """
base = "five_bar"
design = { optimise = false, duration = 8.0 }

[[hidden]]
effect = "acceleration_dependent_friction"
joint = "left"
c = 0.015
"""
folder = TemporaryDirectory()
scenario = Path(folder.name) / "braked.toml"
scenario.write_text(SCENARIO, encoding="utf-8")
data = bench.simulate(scenario)
plain = bench.identify(data)

# %% [markdown]
# ## The law
# One class: its name, its parameters with units, and a column for each, the torque at a value of one.

# %%
LAW = """
from dataclasses import dataclass

import numpy as np

from bench.effects import ActuatorEffect, EffectParameter


@dataclass(frozen=True)
class Brake(ActuatorEffect):
    name = "brake"
    parameters = (EffectParameter("c", "{effort}*s^2/{angle}", positive=True),)

    def torque(self, joint):
        return (np.sign(joint.velocity) * np.abs(joint.acceleration))[:, None]
"""
law = Path(folder.name) / "brake.py"
law.write_text(LAW, encoding="utf-8")

# %% [markdown]
# ## The improvement
# On the recordings that were not fitted.

# %%
braked = bench.identify(data, ["brake:left"], effect_files=[law])
found = braked.effect_parameters["brake"]["left"]["c"]
print(f"c = {found.value:.5f} ± {found.std:.5f} {found.unit}, the truth is 0.015")
print(
    f"error not fitted: {100 * plain.error.validate:.2f} % without it, {100 * braked.error.validate:.3f} % with it"
)

# %% [markdown]
# ## Is the remaining error at the noise floor?
# Correlated errors would indicate another missing effect.

# %%
left = bench.compare(data, braked).where.motors[0]
print(f"left: error {100 * left.error:.3f} %, noise {100 * left.noise:.3f} %")
ratio = np.float64(left.error / left.noise)
folder.cleanup()
