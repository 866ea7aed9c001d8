# %% [markdown]
# # A program as a joint trajectory
# Within each joint's velocity, acceleration and jerk.

# %%
import csv
import pathlib
import tempfile
import tomllib

import numpy as np

import robomill
from robomill import plot

folder = pathlib.Path(tempfile.mkdtemp())
(folder / "part.ngc").write_text("G21 G90 G94\nG64\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F1800\nG1 X4 Y3 A-22\nG1 X0 Y3\nM30\n")
cell = """
[robot]
base_origin_mm = [0, 0, 225.6]
dh = [
  { a_mm = 350, alpha_deg = -90, d_mm = 449.4 },
  { a_mm = 1150, theta_offset_deg = -90 },
  { a_mm = 41, alpha_deg = -90, theta_offset_deg = 180 },
  { alpha_deg = 90, d_mm = -1200 },
  { alpha_deg = -90 },
  { alpha_deg = 180, d_mm = -420, theta_offset_deg = 180 },
]
joint_min_position = [-3.2289, -2.4435, -2.0944, -6.1087, -2.1817, -6.1087]
joint_max_position = [3.2289, 2.4435, 2.7053, 6.1087, 2.1817, 6.1087]
joint_max_velocity = [2.1, 2.0, 1.9, 3.1, 3.0, 3.8]
joint_max_acceleration = [3, 3, 3, 8, 8, 10]
joint_max_jerk = [60, 60, 60, 200, 200, 250]
[workpiece]
origin_mm = [1600, 0, 1600]
rotation_deg = [0, -90, 0]
[tool]
length_mm = 250
[program]
machine = "xyzac-trt"
[smoothing]
tip_tolerance_mm = 0.02
axis_tolerance_deg = 0.1
max_velocity_mm_per_s = 50
max_acceleration_mm_per_s2 = 500
max_jerk_mm_per_s3 = 10000
max_angular_velocity_deg_per_s = 60
max_angular_acceleration_deg_per_s2 = 600
max_angular_jerk_deg_per_s3 = 12000
"""
(folder / "cell.toml").write_text(cell)
limits = {kind: tomllib.loads(cell)["robot"][f"joint_max_{kind}"] for kind in ("velocity", "acceleration", "jerk")}

# %%
smooth = robomill.smooth(folder / "part.ngc", cell=folder / "cell.toml", output=folder / "trajectory.csv")
print(f"{smooth.duration_s:.3f} s, {smooth.max_tip_error_mm:.4f} mm from the program, {smooth.violations} violations")
assert smooth.violations == 0

# %%
with open(folder / "trajectory.csv", newline="") as file:
    rows = list(csv.DictReader(file))
table = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
plot.trajectory(table, limits=limits)
