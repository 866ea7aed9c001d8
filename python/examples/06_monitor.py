# %% [markdown]
# # Chatter detected while it grows
# Three teeth at 6000 rpm, and from 3 s on a vibration that is no multiple of them.

# %%
import numpy as np

from robomill import monitor, plot, units

rate_hz, rotation_hz, chatter_hz, onset_s = 10240.0, 100.0, 847.0, 3.0
time_s = np.arange(int(5 * rate_hz)) / rate_hz
random = np.random.default_rng(1)
wave = lambda frequency_hz: np.sin(2 * np.pi * frequency_hz * time_s)  # noqa: E731
chatter = np.where(time_s < onset_s, 0, np.minimum(20, 0.2 * np.exp(np.clip(time_s - onset_s, 0, None) / 0.1)))
samples = (2 * wave(rotation_hz) + 20 * wave(3 * rotation_hz) + 8 * wave(6 * rotation_hz) + 4 * wave(9 * rotation_hz) +
           random.normal(size=len(time_s)) + chatter * wave(chatter_hz)).astype(np.float32)

# %% Samples go in by any number; who gives no more than are wanted sees every decision.
watch = monitor.ChatterMonitor(options=monitor.MonitorOptions(sample_rate_hz=rate_hz, spindle_speed_rad_per_s=6100 * units.rpm, teeth=3))
decisions, frame = [], 0
while frame < len(samples):
    wanted = watch.frames_to_next_decision()
    decision = watch.push(samples=samples[frame:frame + wanted])
    frame += wanted
    if decision.changed:
        decisions.append((decision.time_s, decision.state))
        print(f"{decision.time_s:.3f} s: {decision.state.name}")
alarm_s = next(time for time, state in decisions if state.name == "chatter")
print(f"chatter began at {onset_s} s and was detected {1000 * (alarm_s - onset_s):.0f} ms later")
assert onset_s < alarm_s < onset_s + 0.5

# %%
plot.spectrogram(samples, rate_hz, decisions=decisions)
