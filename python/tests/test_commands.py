"""init, the monitor and the server from Python: what the program does."""
import json
import os
import subprocess
import urllib.request

import numpy as np
import pytest

import robomill
from robomill import monitor, units

PROGRAM = os.environ["ROBOMILL"]
RATE_HZ = 10240
CONFIG = f"[signal]\nsample_rate_hz = {RATE_HZ}\nchannels = [1]\n[process]\nspindle_speed_rpm = 6000\nteeth = 3\n"


def cut(seconds=4.0, onset_s=2.0):
    """Tooth passing at 300 Hz, and from the onset on a vibration that is no multiple of it."""
    time_s = np.arange(int(seconds * RATE_HZ)) / RATE_HZ
    chatter = np.where(time_s < onset_s, 0, np.minimum(20, 0.2 * np.exp(np.clip(time_s - onset_s, 0, None) / 0.1)))
    wave = lambda frequency_hz: np.sin(2 * np.pi * frequency_hz * time_s)  # noqa: E731
    noise = np.random.default_rng(1).normal(size=len(time_s))
    return (2 * wave(100) + 20 * wave(300) + 8 * wave(600) + noise + chatter * wave(847)).astype(np.float32)


def without_times(events):
    return [{key: value for key, value in event.items() if key != "compute_us"} for event in events]


def test_init_writes_what_the_program_writes(tmp_path):
    made = robomill.init("lobes", tmp_path / "ours.toml", example=True)
    subprocess.run([PROGRAM, "init", "lobes", "--example", "-o", str(tmp_path / "theirs.toml")], check=True, capture_output=True)
    theirs = (tmp_path / "theirs.toml").read_text().splitlines()
    assert (tmp_path / "ours.toml").read_text().splitlines() == [line for line in theirs if not line.startswith("#:schema")]
    assert made.files == (str(tmp_path / "ours.toml"),) and made.next.startswith("lobes ") and made.summary.startswith("wrote ")
    with pytest.raises(robomill.InvalidInput, match="exists"):
        robomill.init("lobes", tmp_path / "ours.toml")
    with pytest.raises(robomill.InvalidInput, match="one of job"):
        robomill.init("lobe", tmp_path / "other.toml")


def test_monitor_gives_the_events_of_the_program(tmp_path):
    config, recording = tmp_path / "monitor.toml", tmp_path / "cut.npy"
    config.write_text(CONFIG)
    np.save(recording, cut())
    ours = robomill.monitor_input(config, input=recording, why=True, report=tmp_path / "page.html")
    subprocess.run([PROGRAM, "monitor", str(config), "--input", str(recording), "--why", "-o", str(tmp_path / "events.jsonl")], check=True, capture_output=True)
    theirs = [json.loads(line) for line in (tmp_path / "events.jsonl").read_text().splitlines()]
    assert without_times(ours.to_dict()["events"]) == without_times(theirs)
    alarm = next(event for event in ours.events if event.state == "chatter")
    assert 2.0 < alarm.time_s < 2.5 and abs(alarm.chatter_frequency_hz - 847) < 5
    assert (tmp_path / "page.html").stat().st_size > 10000


def test_monitor_takes_arrays(tmp_path):
    config, samples = tmp_path / "monitor.toml", cut()
    config.write_text(CONFIG)
    found = robomill.monitor_input(config, samples=samples, every_window=True)
    watch = monitor.ChatterMonitor(options=monitor.MonitorOptions(sample_rate_hz=RATE_HZ, spindle_speed_rad_per_s=6000 * units.rpm, teeth=3))
    states = []
    for begin in range(0, len(samples), 256):
        decision = watch.push(samples=samples[begin:begin + 256])
        if decision.hop > len(states):
            states.append(decision.state.name)
    windows = [event.state for event in found.events if event.event in ("window", "state")]
    assert "chatter" in states and windows == states
    with pytest.raises(TypeError, match="not both"):
        robomill.monitor_input(config, samples=samples, input="cut.wav")


def test_monitor_says_what_is_wrong(tmp_path, monkeypatch):
    config = tmp_path / "monitor.toml"
    config.write_text(CONFIG.replace("teeth = 3", "teeth = -3"))
    with pytest.raises(robomill.InvalidInput, match="teeth = -3"):
        robomill.monitor_input(config, samples=cut())
    monkeypatch.setenv("ROBOMILL", "no-such-program")
    with pytest.raises(FileNotFoundError, match="no-such-program"):
        robomill.monitor_input(config, samples=cut())


def test_serve_ends_with_its_block(tmp_path):
    with robomill.serve_folder(tmp_path) as served:
        assert served.address.startswith("http://127.0.0.1:") and "at http" in repr(served)
        with urllib.request.urlopen(served.address, timeout=10) as answer:
            assert answer.status == 200 and b"<html" in answer.read().lower()
    assert "ended" in repr(served)
    with pytest.raises(OSError):
        urllib.request.urlopen(served.address, timeout=10)
    with pytest.raises(robomill.InvalidInput, match="no such folder"):
        robomill.serve_folder(tmp_path / "none")
