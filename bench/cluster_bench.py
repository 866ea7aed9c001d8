#!/usr/bin/env python3
"""What chunks of a study cost on clusters, beside the threads of one process: cluster_bench.py PROGRAM [chunks] [points a chunk]

Prints wall and processor time of one study done by one thread in one process, by two shards at once, by a Slurm cluster and by a Dask
cluster of two workers on this machine; robomill/jobs/README.md, "Clusters", has what it measured. Needs tools/install full python, and
PYTHONPATH with the module."""
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "testing" / "cluster"))
sys.dont_write_bytecode = True

import cluster_test  # noqa: E402
import rig  # noqa: E402

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
TURNS = 5
CHUNKS, POINTS = (int(word) for word in [*sys.argv[2:], "200", "4"][:2])


def cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def cpu_of(pids):
    """Of processes that live, and of their children that have ended."""
    total = 0
    for pid in pids:
        try:
            total += sum(int(field) for field in pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[11:15])
        except OSError:
            pass
    return total / os.sysconf("SC_CLK_TCK")


class Timed:
    def __enter__(self):
        self.begin, self.cpu_begin = time.monotonic(), cpu_of_children()
        return self

    def __exit__(self, *what):
        self.wall, self.cpu = time.monotonic() - self.begin, cpu_of_children() - self.cpu_begin


def sweep(*words):
    return subprocess.Popen([PROGRAM, "sweep", *map(str, words), "--threads", "1", "--quiet"])


def done(*processes):
    for process in processes:
        assert process.wait() == 0


def report(name, wall, cpu, base=None):
    more = "" if base is None else f", over one process {cpu - base.cpu:+.2f} s CPU: {1e3 * (cpu - base.cpu) / CHUNKS:+.2f} ms a chunk"
    print(f"{name:34} {wall:7.2f} s wall {cpu:7.2f} s CPU{more}", flush=True)


def by_slurm(study, folder):
    """@returns wall, the processor time of the program, and that of Slurm's own processes."""
    wrapper, times = folder.parent / "robomill", folder.parent / "times"
    wrapper.write_text(f"#!/bin/bash\n'{PROGRAM}' \"$@\"\ncode=$?\ntimes >>'{times}'\nexit $code\n")
    wrapper.chmod(0o755)
    with rig.Cluster() as cluster:
        environment = dict(cluster.environment, ROBOMILL=str(wrapper))
        daemons = [process.pid for process in cluster.processes.values()]
        idle_begin, idle = time.monotonic(), cpu_of(daemons)
        time.sleep(3)
        idle = (cpu_of(daemons) - idle) / (time.monotonic() - idle_begin)
        before, begin = cpu_of(daemons), time.monotonic()
        subprocess.run([PROGRAM, "sweep", str(study), "-o", str(folder), "--slurm", "--quiet"], env=environment, check=True)
        submitted = time.monotonic() - begin
        steps = {}
        while not (folder / "results.h5").exists():
            steps.update({pid: cpu_of([pid]) for pid in cluster.own_processes(b"slurmstepd")})
            time.sleep(0.2)
        wall = time.monotonic() - begin
        slurm = cpu_of(daemons) - before + sum(steps.values())
        rig.wait_for(lambda: cluster.ask("squeue", "--noheader") == "", "the merge does not end")
    seconds = [word.rstrip("s").split("m") for word in times.read_text().split()]
    program = sum(60 * float(minutes) + float(rest) for minutes, rest in seconds)
    print(f"  submitted in {submitted:.2f} s; the daemons take {1e3 * idle:.1f} ms CPU a second when idle")
    return wall, program, slurm


def by_dask(study, folder):
    import distributed

    import robomill

    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as workers, \
            distributed.Client(workers) as client:
        pids = list(client.run(os.getpid).values())
        before, begin, own = cpu_of(pids), time.monotonic(), time.process_time()
        robomill.sweep(study, folder, client=client)
        return time.monotonic() - begin, cpu_of(pids) - before, time.process_time() - own


def main():
    with tempfile.TemporaryDirectory(prefix="robomill-bench-") as kept:
        folder = pathlib.Path(kept)
        study = cluster_test.write_study(folder, count=CHUNKS * POINTS // 4, chunk_points=POINTS, shards=2)
        print(f"{CHUNKS} chunks of {POINTS} points")
        ones, twos, whole = [], [], Timed()
        for turn in range(TURNS):  # by turns, and the least of each: other work on the machine takes time from both
            for name in ("one", "two"):
                shutil.rmtree(folder / name, ignore_errors=True)
            ones.append(Timed())
            with ones[-1]:
                done(sweep(study, "-o", folder / "one"))
            twos.append(Timed())
            with twos[-1]:
                done(*(sweep(study, "-o", folder / "two", "--shard", f"{i}/2") for i in (1, 2)))
            twos[-1].noted = sum(float((folder / "two" / f".shard-{i}-of-2.lock").read_text().split()[1]) for i in (1, 2))
        one, two = (min(of, key=lambda timed: timed.cpu) for of in (ones, twos))
        report("one process, one thread", one.wall, one.cpu)
        report("two shards at once", two.wall, two.cpu, one)
        print(f"  processor time against one process {two.cpu / one.cpu:.3f}; idle {100 * min(1 - timed.noted / (2 * timed.wall) for timed in twos):.1f} % of both")
        with Timed() as merged:
            done(sweep(study, "-o", folder / "two", "--merge", folder / "two" / "results.csv"), sweep(study, "-o", folder / "two", "--merge", folder / "two" / "results.h5"))
        report("  its two tables", merged.wall, merged.cpu)
        (folder / "study-of-one.toml").write_text(study.read_text().replace(f"chunk_points = {POINTS}", f"chunk_points = {CHUNKS * POINTS}"))
        with whole:
            done(sweep(folder / "study-of-one.toml", "-o", folder / "whole"))
        report("one process, one chunk", whole.wall, whole.cpu, one)
        wall, program, slurm = by_slurm(study, folder / "slurm")
        report("Slurm, two tasks and tables", wall, program + slurm, one)
        print(f"  of it Slurm's own processes {slurm:.2f} s CPU")
        wall, workers, client = by_dask(study, folder / "dask")
        report("Dask, two workers", wall, workers + client, one)
        print(f"  of it the client and scheduler {client:.2f} s CPU, {1e3 * client / CHUNKS:.2f} ms a chunk; workers {workers:.2f} s")
        tables = [(folder / name / "results.h5").read_bytes() for name in ("one", "two", "slurm", "dask")]
        assert len(set(tables)) == 1


if __name__ == "__main__":
    main()
