# %% [markdown]
# # The whole job: hits to safe cutting conditions
# `init` writes documents that run as they are, with values that are made up.

# %%
import json
import os
import pathlib
import tempfile

import robomill
from robomill import plot

folder = pathlib.Path(tempfile.mkdtemp())
print(robomill.init("job", folder, example=True).summary)

# %%
job = robomill.plan(folder / "job.toml", output=folder / "out")
best = job.recommended
print(f"{best.spindle_speed_rpm:.0f} rpm, {best.axial_depth_mm:.2f} mm; limited by {best.limited_by}")
print(sorted(os.listdir(folder / "out")))

# %% Each stage's result is a document of its own.
modes = robomill.modes(folder / "out/tip.uff")
plot.frfs(robomill.frf(folder / "hits.toml"), fit=modes)
plot.lobes(json.loads((folder / "out/lobes.json").read_text()))
