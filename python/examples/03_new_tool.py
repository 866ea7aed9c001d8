# %% [markdown]
# # A tool that nobody has hit: receptance coupling
# From a drawing to the receptance at the tip.

# %%
import numpy as np

from robomill import coupling, modal, units

shank = coupling.Segment(length_m=70 * units.mm, diameter_m=12 * units.mm, youngs_modulus_pa=580 * units.gpa, density_kg_per_m3=14400.0,
                         poissons_ratio=0.22, loss_factor=0.005, beam="euler-bernoulli")
frequency_hz = np.linspace(10, 4000, 7981)


def first_bending_hz(assembly):
    tip = coupling.tip_frfs(assembly=assembly, frequency_hz=frequency_hz).frfs
    receptance = next(one.receptance for one in tip.frfs if modal.to_string(name=one.name) == "xx")
    return frequency_hz[np.abs(receptance).argmax()]


# %% In a rigid wall it is the cantilever of Euler and Bernoulli.
clamped = coupling.Assembly(tool=[shank])
closed_hz = (1.875104069 / shank.length_m) ** 2 * np.sqrt(shank.youngs_modulus_pa / shank.density_kg_per_m3) * shank.diameter_m / 4 / (2 * np.pi)
print(f"cantilever {first_bending_hz(clamped):.1f} Hz, in closed form {closed_hz:.1f} Hz")
assert abs(first_bending_hz(clamped) / closed_hz - 1) < 5e-4

# %% In a holder, with an elastic joint.
joint = coupling.Joint(translational_stiffness_n_per_m=1.5e8, translational_damping_n_s_per_m=200.0, rotational_stiffness_n_m_per_rad=3e4,
                       rotational_damping_n_m_s_per_rad=0.05)
holder = coupling.Holder(segments=[coupling.Segment(length_m=60 * units.mm, diameter_m=40 * units.mm, youngs_modulus_pa=210 * units.gpa,
                                                    density_kg_per_m3=7850.0, loss_factor=0.01)])
elastic = coupling.Assembly(tool=[shank], joint=joint, holder=holder)
print(f"in a holder {first_bending_hz(elastic):.1f} Hz")
assert first_bending_hz(elastic) < first_bending_hz(clamped)
