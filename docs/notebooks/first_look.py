# ---
# jupyter: {jupytext: {text_representation: {extension: .py, format_name: percent}}}
# ---

# %% [markdown]
# # From measurements to gains, and whether to trust them
# A five-bar whose truth is known replaces a real robot.

# %%
import bench

data = bench.simulate("tutorial")  # a dataset: what a controller would have logged
result = bench.identify(data)

# %% [markdown]
# ## The result
# Every number has its standard error. That of the left motor's gain is large: the model lacks something.

# %%
table = result.to_dataframe()
gains = table[table["kind"] == "drive gain"]
print(gains[["name", "value", "std", "unit"]].round(3).to_string(index=False))

# %% [markdown]
# ## Where does the model fail?

# %%
errors = bench.compare(data, result)
left, right = errors.where.motors
print(f"left: {left.error / left.noise:.0f} times the noise, right: {right.error / right.noise:.1f} times")

# %% [markdown]
# ## What is missing?
# Judged on recordings that were not fitted.

# %%
diagnosis = bench.diagnose(data)
print(diagnosis.missing)

# %% [markdown]
# ## With it
# A missing effect distorts the other parameters: the gain of the left motor was 6 % off, and its large standard error
# showed it.

# %%
better = diagnosis.after
before, after = result.drive_gains["left"], better.drive_gains["left"]
print(f"gain of the left motor without it: {before.value:.2f} ± {before.std:.2f}")
print(f"gain of the left motor with it: {after.value:.4f} ± {after.std:.4f}; the truth is 3.3")
