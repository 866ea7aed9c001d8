# %% [markdown]
# # Stability lobes, beside a method of one's own
# Four teeth in a full slot and one flexible direction: the teeth's forces add up to a constant stiffness, so that the limit of all
# speeds is known in closed form.

# %%
import numpy as np

from robomill import cutting, modal, stability, units

mass_kg, natural_hz, damping_ratio = 0.6, 650.0, 0.025
radial = 250 * units.n_per_mm2
milling = cutting.Milling(
    tool=cutting.FlatEndMill(teeth=4, diameter_m=16 * units.mm),
    immersion=cutting.immersion(direction="slot", radial_depth_m=0.0, diameter_m=16 * units.mm),
    coefficients=cutting.ForceCoefficients(tangential_n_per_m2=700 * units.n_per_mm2, radial_n_per_m2=radial))
dynamics = modal.modes_from_mass(x=[modal.MassMode(frequency_hz=natural_hz, damping_ratio=damping_ratio, modal_mass_kg=mass_kg)], y=[])
problem = stability.LobesProblem(milling=milling, dynamics=dynamics)
options = stability.LobesOptions(spindle_speed_rad_per_s=[4000 * units.rpm, 12000 * units.rpm], axial_depth_m=[0, 10 * units.mm], grid=[161, 50])

# %%
lobes = stability.compute_lobes(problem=problem, options=options)
speed_rpm = np.array([one.spindle_speed_rad_per_s for one in lobes.limit]) / units.rpm
limit_mm = np.array([one.axial_depth_m if one.status.name == "found" else np.nan for one in lobes.limit]) / units.mm

# %% The method beside it: a = -1 / (2 Kr min Re G).
omega = np.linspace(0.9, 1.2, 200001) * 2 * np.pi * natural_hz
response = 1 / mass_kg / ((2 * np.pi * natural_hz) ** 2 - omega**2 + 2j * damping_ratio * 2 * np.pi * natural_hz * omega)
own_mm = -1 / (2 * radial * response.real.min()) / units.mm
print(f"stable at every speed: {np.nanmin(limit_mm):.4f} mm, own method {own_mm:.4f} mm")
assert abs(np.nanmin(limit_mm) / own_mm - 1) < 1e-3

# %% Another tool is a copy with other values.
three = stability.compute_lobes(problem=problem.replace(milling=milling.replace(tool=milling.tool.replace(teeth=3))), options=options)
print(f"three teeth, at {speed_rpm[80]:.0f} rpm: {three.limit[80].axial_depth_m / units.mm:.3f} mm")
