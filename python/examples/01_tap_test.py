# %% [markdown]
# # A tap test: hammer hits to modes
# Three hits on a structure that is known are made here, so that the result can be judged. Hits of your own are columns of a file:
# `robomill.frf("hits.toml")` reads those.

# %%
import numpy as np

from robomill import modal, plot

rate_hz, mass_kg, natural_hz, damping_ratio = 12800.0, 0.8, 480.0, 0.02
time_s = np.arange(12800) / rate_hz
decay = 2 * np.pi * natural_hz * damping_ratio
ring = 2 * np.pi * natural_hz * np.sqrt(1 - damping_ratio**2)
impulse_response = np.exp(-decay * time_s) * np.sin(ring * time_s) / (mass_kg * ring)

random = np.random.default_rng(1)
x = modal.parse_dof(text="x")
hits = []
for peak_n in (180.0, 210.0, 195.0):
    force = np.zeros(len(time_s))
    pulse = int(0.001 * rate_hz)
    force[400:400 + pulse] = peak_n * np.sin(np.pi * np.arange(pulse) / pulse) ** 2
    displacement = np.convolve(force, impulse_response)[:len(time_s)] / rate_hz
    displacement += 1e-4 * np.abs(displacement).max() * random.normal(size=len(time_s))
    channel = modal.HitChannel(dof=x, samples=displacement)
    hits.append(modal.Hit(excitation=x, sample_rate_hz=rate_hz, force_n=force, responses=[channel]))

# %% Each hit is judged, each FRF has a grade.
frfs = modal.estimate_frfs(hits=hits, options=modal.HitOptions(response="displacement"))
for grade in frfs.grades:
    print(modal.to_string(name=grade.name), grade.grade.name, f"coherence {grade.mean_coherence:.4f}")

# %% Modes with their standard deviations.
fit = modal.fit_modes(set=frfs.set, options=modal.FitOptions(band_low_hz=200, band_high_hz=900))
mode = fit.model.modes[0]
print(f"{mode.frequency_hz:.2f} ± {mode.frequency_std_hz:.2f} Hz (is {natural_hz}), "
      f"{100 * mode.damping_ratio:.3f} ± {100 * mode.damping_ratio_std:.3f} % (is {100 * damping_ratio})")
assert abs(mode.frequency_hz / natural_hz - 1) < 1e-3

# %% An array of a result is the library's memory: nothing was copied.
receptance = frfs.set.frfs[0].receptance
assert not receptance.flags.writeable and not receptance.flags.owndata
