"""A first cut from Python: a notebook in the percent format."""

# %% [markdown]
# # A first cut from Python
#
# A page in the percent format: VS Code, Spyder and Jupyter (with jupytext) open it as a notebook; `python
# docs/first_cut.py` runs it. It cuts a small, coarse block in some seconds: to see how things work, not for figures.
# Units are mm, tonne, s and K everywhere (so N, MPa and mJ); forces and energies are per mm of width.

# %%
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt

import pfemcut

# %% [markdown]
# ## A case
# A case is a file, or a table of the same shape. `changes` replaces single values by `section.key`.

# %%
table = {
    "title": "A first cut",
    "workpiece": {"length": 1.2, "height": 0.6, "material": "aisi4340"},
    "tool": {"rake": 6.0, "tip_radius": 0.025},
    "cutting": {"speed": 3330.0, "depth": 0.1, "travel": 0.5},
    "mesh": {
        "tip_size": 0.008,
        "shear_zone_size": 0.025,
        "chip_size": 0.03,
        "surface_size": 0.03,
        "far_size": 0.3,
    },
    "time": {"step": 4e-7},
}
case = pfemcut.load_case(table, {"cutting.travel": 0.05, "mesh.growth": 0.2})
for name, text in case.figures().items():
    print(f"{name:<11} {text}")
for warning in case.warnings():
    print("warning:", warning)

# %% [markdown]
# ## Step by step
# A `Simulation` is in memory. A callback gets a `Moment`: measures, fields, and `stop`.

# %%
simulation = pfemcut.Simulation(case)
first = simulation.step()
print(f"step {first.step}: {first.nodes} particles, travel {first.travel:.5f} mm")


def watch(moment: pfemcut.Moment) -> None:
    """Stop when the cutting force exceeds 150 N/mm."""
    measures = moment.measures
    if measures.cutting_force > 150.0:
        moment.stop(f"{measures.cutting_force:.0f} N/mm at {measures.travel:.4f} mm")


simulation.run(after_step=watch)
print(f"{simulation.measures.cutting_force:.1f} N/mm after {simulation.measures.travel:.4f} mm")

# %% [markdown]
# ## Fields
# As arrays, as a meshio mesh (`to_meshio`), and as a PyVista grid (`to_pyvista`, if pyvista is installed).

# %%
fields = simulation.fields
print(fields.names)
print("hottest:", fields["temperature"].max(), fields.unit("temperature"))
fields.to_meshio().write(Path(mkdtemp()) / "fields.vtu")

figure, panels = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
fields.plot("temperature", panels[0])
fields.plot("equivalent_plastic_strain", panels[1])

# %% [markdown]
# ## To the end, with files
# `run` writes what `pfemcut run` writes: history, fields, checkpoints, summary, report.

# %%
small = pfemcut.load_case(table, {"cutting.travel": 0.01, "output.figures": False})
results = pfemcut.run(small, Path(mkdtemp()) / "first_cut")
history = results.history
figure, axes = plt.subplots(layout="constrained")
axes.plot(history["travel"], history["cutting_force"], label="cutting force")
axes.plot(history["travel"], history["thrust_force"], label="thrust force")
axes.set(xlabel="travel (mm)", ylabel="force on the tool (N/mm)")
axes.legend()
plt.show()
