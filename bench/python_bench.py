"""Import, a call's overhead, and the monitor's speed by hops against one call for all samples: python3 bench/python_bench.py [SAMPLES]"""
import subprocess
import sys
import time
import timeit

import numpy as np

from robomill import modal, monitor, units

count = int(float(sys.argv[1])) if len(sys.argv) > 1 else 10_000_000
imported = min(float(subprocess.run([sys.executable, "-c", "import numpy, time; t = time.perf_counter(); import robomill; print(time.perf_counter() - t)"],
                                    capture_output=True, text=True, check=True).stdout) for _ in range(5))
print(f"import robomill, NumPy loaded before: {1000 * imported:.0f} ms")
calls = 20000
print(f"a call with a keyword: {min(timeit.repeat(lambda: modal.parse_frf_name(text='xy'), number=calls, repeat=5)) / calls * 1e6:.2f} µs")

rate_hz = 10240.0
time_s = np.arange(count) / rate_hz
samples = (20 * np.sin(2 * np.pi * 300 * time_s) + np.random.default_rng(1).normal(size=count)).astype(np.float32)


def seconds(hop):
    watch = monitor.ChatterMonitor(options=monitor.MonitorOptions(sample_rate_hz=rate_hz, spindle_speed_rad_per_s=6000 * units.rpm, teeth=3))
    begin = time.perf_counter()
    for frame in range(0, count, hop):
        watch.push(samples=samples[frame:frame + hop])
    return time.perf_counter() - begin


pairs = [(seconds(256), seconds(count)) for _ in range(3)]
hops, at_once = (min(column) for column in zip(*pairs))
print(f"monitor, {count:,} samples: {hops:.2f} s in calls of 256, {at_once:.2f} s in one call of C++: {100 * at_once / hops:.0f} % of its speed")
