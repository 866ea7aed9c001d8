"""robomill beside NumPy, SciPy and pandas: the same task, how far the answers differ, processor time and its ratio, one thread each.

    PYTHONPATH=build/python python3 bench/peers.py [--quick]        needs python3-scipy and python3-pandas

prints the table of docs/site/reference/benchmarks.md.
"""
import os
import sys
import tempfile
import time
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
import pandas as pd
import scipy.io
import scipy.io.wavfile
import scipy.linalg

import robomill
from robomill import cutting, io, modal, stability, units

robomill.set_thread_count(threads=1)
quick = "--quick" in sys.argv[1:]
rows = []


def seconds(work, repeats=3):
    """Least processor time of a few runs, and the result."""
    best = np.inf
    for _ in range(1 if quick else repeats):
        begin = time.process_time()
        result = work()
        best = min(best, time.process_time() - begin)
    return best, result


def compare(task, ours, peer_name, peer, difference, repeats=3):
    own_s, own = seconds(ours, repeats)
    peer_s, other = seconds(peer, repeats)
    rows.append((task, peer_name, difference(own, other), own_s, peer_s))


def time_text(value):
    return f"{value:.3g} s" if value >= 1 else f"{1000 * value:.3g} ms"


# A cut of two modes by semi-discretization with 40 steps a tooth period, as [Insperger2004] gives it: spectral radii of a chart.
diameter_m, teeth, intervals = 12 * units.mm, 2, 40
tangential, radial = 700 * units.n_per_mm2, 250 * units.n_per_mm2
modes = [modal.MassMode(frequency_hz=900, damping_ratio=0.012, modal_mass_kg=0.05),
         modal.MassMode(frequency_hz=1040, damping_ratio=0.011, modal_mass_kg=0.04)]
immersion = cutting.immersion(direction="up", radial_depth_m=3 * units.mm, diameter_m=diameter_m)
milling = cutting.Milling(tool=cutting.FlatEndMill(teeth=teeth, diameter_m=diameter_m), immersion=immersion,
                          coefficients=cutting.ForceCoefficients(tangential_n_per_m2=tangential, radial_n_per_m2=radial))
problem = stability.LobesProblem(milling=milling, dynamics=modal.modes_from_mass(x=modes[:1], y=modes[1:]))
speeds, depths = (6, 5) if quick else (20, 20)
options = stability.LobesOptions(spindle_speed_rad_per_s=[8000 * units.rpm, 20000 * units.rpm], axial_depth_m=[0.2 * units.mm, 3 * units.mm],
                                 grid=[speeds, depths], intervals=intervals, method="semi-discretization", output="map")


def directional_means():
    """Force on the tool per depth and displacement of a tooth period ago, a mean over each interval: intervals x 2 x 2 [N/m^2]."""
    fine = 2000
    phi = 2 * np.pi / teeth * (np.arange(intervals * fine) + 0.5) / (intervals * fine)
    out = np.zeros((len(phi), 2, 2))
    for tooth in range(teeth):
        angle = (phi + 2 * np.pi * tooth / teeth) % (2 * np.pi)
        sine, cosine = np.sin(angle), np.cos(angle)
        x, y = tangential * cosine + radial * sine, tangential * sine - radial * cosine
        cuts = (angle >= immersion.entry_rad) & (angle <= immersion.exit_rad)
        out += np.moveaxis(np.array([[-sine * x, -cosine * x], [sine * y, cosine * y]]) * cuts, 2, 0)
    return out.reshape(intervals, fine, 2, 2).mean(axis=1)


def semi_discretization():
    mass = np.array([mode.modal_mass_kg for mode in modes])
    omega = 2 * np.pi * np.array([mode.frequency_hz for mode in modes])
    zeta = np.array([mode.damping_ratio for mode in modes])
    matrices, size = directional_means(), 4 + 2 * intervals
    radii = np.empty((depths, speeds))
    for column, speed in enumerate(np.linspace(*options.spindle_speed_rad_per_s, speeds)):
        step_s = 2 * np.pi / speed / teeth / intervals
        for row, depth_m in enumerate(np.linspace(*options.axial_depth_m, depths)):
            product = np.eye(size)
            for force in depth_m * matrices:
                a, b = np.zeros((4, 4)), np.zeros((4, 2))
                a[:2, 2:] = np.eye(2)
                a[2:, :2] = -np.diag(omega ** 2) + force / mass[:, None]
                a[2:, 2:] = -np.diag(2 * zeta * omega)
                b[2:] = -force / mass[:, None]
                power = scipy.linalg.expm(a * step_s)
                held = (power - np.eye(4)) @ np.linalg.solve(a, b)
                step = np.zeros((size, size))
                step[:4, :4] = power
                step[:4, -2:] += held / 2
                step[:4, -4:-2] += held / 2
                step[4:6, :2] = np.eye(2)
                step[6:, 4:-2] = np.eye(size - 6)
                product = step @ product
            radii[row, column] = np.abs(np.linalg.eigvals(product)).max()
    return radii


compare(f"spectral radii of a two-mode cut at {speeds} × {depths} points by semi-discretization, {intervals} steps a tooth",
        lambda: stability.compute_lobes(problem=problem, options=options).spectral_radius, "[Insperger2004] in NumPy and SciPy",
        semi_discretization, lambda own, other: f"{np.abs(own / other - 1).max():.1e} of the radius", repeats=1)

# FRFs of hammer hits: windows and the search for double hits are ours alone.
rate_hz, length, hits = 25600.0, 32768, 10
time_s = np.arange(length) / rate_hz
random = np.random.default_rng(1)
force = np.where(time_s < 0.5e-3, 400 * np.sin(np.pi * time_s / 0.5e-3), 0.0)
pole = 2 * np.pi * 700
ringing = np.exp(-0.02 * pole * time_s) * np.cos(pole * time_s)
response = np.fft.irfft(np.fft.rfft(force, 2 * length) * np.fft.rfft(ringing, 2 * length))[:length]
records = [(force * scale, response * scale + 0.02 * random.normal(size=length)) for scale in random.uniform(0.8, 1.2, hits)]
dof = modal.parse_dof(text="x")
hammer = [modal.Hit(file=f"hit {i}", excitation=dof, sample_rate_hz=rate_hz, force_n=f,
                    responses=[modal.HitChannel(dof=dof, samples=a)]) for i, (f, a) in enumerate(records)]
plain = modal.HitOptions(force_window=False, exponential_window="off", min_frequency_hz=100, max_frequency_hz=5000)


def h1():
    forces, answers = (np.fft.rfft(column) for column in map(np.array, zip(*records)))
    return (answers * forces.conj()).sum(axis=0) / (np.abs(forces) ** 2).sum(axis=0)


def differs(own, other):
    frequency = np.fft.rfftfreq(length, 1 / rate_hz)
    used = np.isin(np.round(frequency, 6), np.round(own.set.frequency_hz, 6))
    receptance = other[used] / -(2 * np.pi * frequency[used]) ** 2
    return f"{np.abs(own.set.frfs[0].receptance - receptance).max() / np.abs(receptance).max():.1e} of the peak"


compare(f"an FRF of {hits} hits of {length:,} samples", lambda: modal.estimate_frfs(hits=hammer, options=plain), "H1 in NumPy", h1, differs)


def recording(path):
    """All samples of a file by the source that the monitor reads from."""
    source = io.open_samples(path=path, columns=io.SampleColumns(channels=["1"] if path.suffix == ".wav" else ["acceleration"]))
    block, parts = io.SampleBlock(), []
    while source.next(frames=1 << 20, block=block):
        parts.append(np.array(block.samples))
    return np.concatenate(parts)


with tempfile.TemporaryDirectory() as folder:
    count = 200_000 if quick else 2_000_000
    samples = random.normal(size=count)
    wav, csv, mat = (Path(folder) / f"record.{ending}" for ending in ("wav", "csv", "mat"))
    scipy.io.wavfile.write(wav, 25600, samples.astype(np.float32))
    pd.DataFrame({"time_s": np.arange(count) / rate_hz, "acceleration": samples}).to_csv(csv, index=False)
    scipy.io.savemat(mat, {"acceleration": samples[:, None], "sample_rate_hz": rate_hz})
    same = lambda own, other: f"{np.abs(own - other).max():.0e}"
    compare(f"WAV of {count:,} samples, as real numbers", lambda: recording(wav), "scipy.io.wavfile",
            lambda: scipy.io.wavfile.read(wav)[1].astype(float), same)
    compare(f"CSV of {count:,} rows of two columns", lambda: recording(csv), "pandas.read_csv",
            lambda: pd.read_csv(csv)["acceleration"].to_numpy(), same)
    compare(f"MAT file of {count:,} samples", lambda: recording(mat), "scipy.io.loadmat",
            lambda: scipy.io.loadmat(mat)["acceleration"].ravel(), same)

print("| task | peer | greatest difference | robomill | peer | peer / robomill |\n|---|---|---|---|---|---|")
for task, peer_name, difference, own_s, peer_s in rows:
    print(f"| {task} | {peer_name} | {difference} | {time_text(own_s)} | {time_text(peer_s)} | {peer_s / own_s:.2g} |")
