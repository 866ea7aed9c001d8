# %% [markdown]
# # Cutting forces of a document
# The verbs of the command line are functions: a file in, its JSON document out, with arrays in the place of lists.

# %%
import pathlib
import tempfile

import robomill
from robomill import plot

folder = pathlib.Path(tempfile.mkdtemp())
(folder / "forces.toml").write_text("""
[tool]
kind = "ball-end"
teeth = 2
diameter_mm = 10
helix_deg = 30
[cut]
spindle_speed_rpm = 8000
feed_per_tooth_mm = 0.08
axial_depth_mm = 0.6
stepover_mm = 0.4
direction = "up"
lead_deg = 15
tilt_deg = 5
[coefficients]
tangential_n_per_mm2 = 800
radial_n_per_mm2 = 300
axial_n_per_mm2 = 150
""")

# %%
forces = robomill.forces(folder / "forces.toml")
print(f"peak {forces.peak_force_n:.1f} N, torque {forces.torque_n_m:.4f} N·m")
print(forces.summary)
plot.forces(forces)

# %% Bad input is an error with its parts.
try:
    robomill.forces(folder / "forces.toml", program="none.ngc")
except robomill.InvalidInput as error:
    print(error)
