# %% [markdown]
# # A method of one's own beside ours
# From measured FRFs to modes and lobes; then the zeroth-order limit of Altintas and Budak, written here in NumPy, on the same modes. The
# cut is a narrow one: few teeth, little immersion, where that method is known to miss a part of the limit.

# %% Measured FRFs: here of known modes, with noise; yours are arrays too, or files for `modal.read_frfs`.
import sys

import matplotlib.pyplot as plt
import numpy as np

from robomill import cutting, exchange, modal, stability, units

frequency_hz = np.arange(100.0, 2000.0, 0.5)
omega = 2 * np.pi * frequency_hz
random = np.random.default_rng(1)


def measured(mass_kg, natural_hz, damping_ratio):
    natural = 2 * np.pi * natural_hz
    receptance = 1 / mass_kg / (natural**2 - omega**2 + 2j * damping_ratio * natural * omega)
    noise = 5e-3 * np.abs(receptance).max() * (random.normal(size=(2, len(omega))) / np.sqrt(2))
    return receptance + noise[0] + 1j * noise[1]


frfs = exchange.frfs_from_arrays(frequency_hz, {"xx": measured(0.040, 922.0, 0.011),
                                                "yy": measured(0.045, 1030.0, 0.012)})

# %% Modes of them.
fit = modal.fit_modes(set=frfs, options=modal.FitOptions(band_low_hz=500, band_high_hz=1600))
for mode in fit.model.modes:
    print(f"{mode.frequency_hz:.2f} ± {mode.frequency_std_hz:.2f} Hz, "
          f"{100 * mode.damping_ratio:.3f} ± {100 * mode.damping_ratio_std:.3f} %")

# %% Lobes of a cut, by semi-discretization.
diameter_m, teeth = 12 * units.mm, 2
tangential, radial = 712 * units.n_per_mm2, 287 * units.n_per_mm2
tool = cutting.FlatEndMill(teeth=teeth, diameter_m=diameter_m)
immersion = cutting.immersion(direction="up", radial_depth_m=1.8 * units.mm, diameter_m=diameter_m)
coefficients = cutting.ForceCoefficients(tangential_n_per_m2=tangential, radial_n_per_m2=radial)
milling = cutting.Milling(tool=tool, immersion=immersion, coefficients=coefficients)
problem = stability.LobesProblem(milling=milling, dynamics=fit.model)
options = stability.LobesOptions(spindle_speed_rad_per_s=[8000 * units.rpm, 30000 * units.rpm],
                                 axial_depth_m=[0, 6 * units.mm], grid=[221, 60],
                                 method="semi-discretization")
ours = stability.compute_lobes(problem=problem, options=options)
speed_rpm = np.array([one.spindle_speed_rad_per_s for one in ours.limit]) / units.rpm


def limits_mm(lobes):
    return np.array([one.axial_depth_m if one.status.name == "found" else np.nan for one in lobes.limit]) / units.mm


# %% The method beside it. The force per axial depth of a tooth at φ is κ(φ) (q(t) - q(t - τ)); its mean over a revolution is Ā.
phi = np.linspace(immersion.entry_rad, immersion.exit_rad, 2001)
sine, cosine = np.sin(phi), np.cos(phi)
along_x, along_y = tangential * cosine + radial * sine, tangential * sine - radial * cosine
kappa = np.array([[-sine * along_x, -cosine * along_x], [sine * along_y, cosine * along_y]])
mean = teeth / (2 * np.pi) * np.trapz(kappa, phi)

# 1 = a λ (1 - exp(-iωτ)) at the limit, λ the eigenvalues of Ā G: with z = 1/λ, a = |z|² / (2 Re z) and exp(-iωτ) = 1 - z/a.
response = stability.FrequencyResponse.of_modes(problem=problem)
chatter = 2 * np.pi * np.arange(700.0, 1500.0, 0.05)
z = 1 / np.linalg.eigvals([mean @ response.at(frequency_rad_per_s=one) for one in chatter])
z[z.real <= 0] = np.nan  # no depth has a limit there
depth_m = np.abs(z) ** 2 / (2 * z.real)
with np.errstate(invalid="ignore"):
    phase = -np.angle(1 - z / depth_m) % (2 * np.pi)

# Each lobe is a curve of speeds and depths; the limit is the lowest of them at a speed.
own_mm = np.full(len(speed_rpm), np.nan)
for lobe in range(10):
    rpm = 60 * chatter[:, None] / (teeth * (phase + 2 * np.pi * lobe))
    for i, column in np.argwhere(np.abs(np.diff(rpm, axis=0)) < 500):  # more is the step from one lobe to the next
        ends, depths = rpm[i:i + 2, column], depth_m[i:i + 2, column]
        for k in range(*np.searchsorted(speed_rpm, sorted(ends))):
            share = (speed_rpm[k] - ends[0]) / (ends[1] - ends[0])
            own_mm[k] = np.fmin(own_mm[k], (depths[0] + share * (depths[1] - depths[0])) / units.mm)

# %% It is ours of the same name. Semi-discretization has the same lowest limit, and lower ones where a flip takes over.
same = limits_mm(stability.compute_lobes(problem=problem, options=options.replace(method="zeroth-order")))
shown = np.isfinite(own_mm) & np.isfinite(same)
print(f"against our zeroth order: {100 * np.abs(own_mm / same - 1)[shown].max():.3f} % at most, at {shown.sum()} speeds")
both = np.isfinite(own_mm) & np.isfinite(limits_mm(ours))
ratio = (limits_mm(ours) / own_mm)[both]
print(f"semi-discretization to zeroth order: {ratio.min():.2f} to {ratio.max():.2f}")
flips = [point for point in ours.boundary if point.kind.name == "flip"]
print(f"{len(flips)} points of the boundary are flips, which the zeroth order does not have")
assert np.abs(own_mm / same - 1)[shown].max() < 5e-3 and shown.sum() > 100 and flips and ratio.min() < 0.9

# %% Both in one figure.
figure, axes = plt.subplots(figsize=(9, 4), layout="constrained")
axes.plot(speed_rpm, limits_mm(ours), label="semi-discretization, robomill")
axes.plot(speed_rpm, own_mm, "--", label="zeroth order, NumPy")
axes.set(xlabel="spindle speed in rpm", ylabel="axial depth in mm", xlim=(8000, 30000), ylim=(0, 6))
axes.legend()
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1])
