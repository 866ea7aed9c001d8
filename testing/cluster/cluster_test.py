#!/usr/bin/env python3
"""Studies on a Slurm cluster: cluster_test.py PROGRAM. Exit 77 (skipped) where Slurm is missing, or ROBOMILL_FULL is not 1."""
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rig

PROGRAM = ""
CUT = (pathlib.Path(__file__).resolve().parents[2] / "testing/jobs/study/lobes.toml").read_text()
STUDY = """
[study]
job = "lobes"
base = "lobes.toml"
collect = {collect}
chunk_points = {chunk_points}
[[vary]]
key = "cut.radial_depth_mm"
range = [2, 8]
count = {count}
[[vary]]
key = "tool.teeth"
values = [2, 3, 4, 5]
[slurm]
shards = {shards}
time_min = 30
memory_mb = 200
restarts = {restarts}
"""
TABLES = ["results.csv", "results.h5"]
KILLS = 20


def write_study(folder, *, count, chunk_points, shards=4, restarts=1000, speeds=1):
    collect = ["abs_mu@8000,1.0", "chatter_frequency@8000", *(f"limit@{8000 + 50 * i}" for i in range(speeds))]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "lobes.toml").write_text(CUT)
    (folder / "study.toml").write_text(STUDY.format(collect=json.dumps(collect), count=count, chunk_points=chunk_points, shards=shards, restarts=restarts))
    return folder / "study.toml"


def chunks_of(folder):
    return {path.name: path.stat().st_ino for path in folder.glob("chunks/[0-9]*.chunk")}


class OnACluster(unittest.TestCase):
    def setUp(self):
        kept = tempfile.TemporaryDirectory(prefix="robomill-cluster-")
        self.addCleanup(kept.cleanup)
        # What scripts must quote: blanks, quotes, what a shell or Slurm's patterns would replace.
        self.folder = pathlib.Path(kept.name) / "a 'study' of \"ours\" #1 $HOME 100% %a"
        self.out = self.folder / "out"

    def robomill(self, *words, code=0, environment=None, program=None):
        done = subprocess.run([program or PROGRAM, *map(str, words)], env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, code, done.stderr + done.stdout)
        return done.stdout + done.stderr

    def tables_by_threads(self, study):
        self.robomill("sweep", study, "-o", self.folder / "threads")
        return {name: (self.folder / "threads" / name).read_bytes() for name in TABLES}

    def merge_state(self, cluster):
        jobs = json.loads((self.out / "slurm" / "jobs.json").read_text())
        return cluster.ask("squeue", "--noheader", "--states=all", "--format=%T", f"--jobs={jobs['merge']}").strip()

    def wait_for_merge(self, cluster, state):
        rig.wait_for(lambda: self.merge_state(cluster) == state, f"the merge does not become {state}: {self.merge_state(cluster)}",
                     stalled=cluster.look_again)

    def assert_same_tables(self, expected):
        for name, content in expected.items():
            if not (self.out / name).exists():
                merge = self.out / "slurm" / "merge.out"
                self.fail(f"no {name}; merge.out: {merge.read_text() if merge.exists() else 'is not there'}")
            self.assertEqual((self.out / name).read_bytes(), content, name)

    def test_a_dry_run_shows_the_scripts_and_writes_nothing(self):
        study = write_study(self.folder, count=20, chunk_points=10)
        said = self.robomill("sweep", study, "-o", self.out, "--slurm", "--dry-run")
        self.assertIn("#SBATCH --array=1-4\n", said)
        self.assertIn("merge.sh", said)
        self.assertFalse(self.out.exists())

    def test_a_study_has_the_bytes_of_one_by_threads(self):
        study = write_study(self.folder, count=40, chunk_points=8)
        expected = self.tables_by_threads(study)
        with rig.Cluster() as cluster:
            said = self.robomill("sweep", study, "-o", self.out, "--slurm", environment=cluster.environment)
            self.assertIn("160 points in 20 chunks of 8, 4 tasks.", said)
            again = self.robomill("sweep", study, "-o", self.out, "--slurm", environment=cluster.environment, code=1)
            self.assertIn("is being worked on by job 1 of Slurm", again)
            self.wait_for_merge(cluster, "COMPLETED")
            said = self.robomill("sweep", study, "-o", self.out, "--status", environment=cluster.environment)
            self.assertIn("Job 1 of Slurm has 4 tasks: 4 done.", said)
        self.assert_same_tables(expected)
        self.assertEqual(len(list((self.out / "slurm").glob("[1-4].out"))), 4)

    def test_scripts_can_be_submitted_by_hand(self):
        study = write_study(self.folder, count=4, chunk_points=4, shards=2)
        expected = self.tables_by_threads(study)
        with rig.Cluster() as cluster:
            self.robomill("sweep", study, "-o", self.out, "--slurm", environment=cluster.environment)
            self.wait_for_merge(cluster, "COMPLETED")
            for name in TABLES:
                (self.out / name).unlink()
            for chunk in self.out.glob("chunks/*"):
                chunk.unlink()
            array = cluster.ask("sbatch", "--parsable", str(self.out / "slurm" / "array.sh")).strip()
            merge = cluster.ask("sbatch", "--parsable", f"--dependency=afterany:{array}", str(self.out / "slurm" / "merge.sh")).strip()
            rig.wait_for(lambda: cluster.ask("squeue", "--noheader", "--states=all", "--format=%T", f"--jobs={merge}").strip() == "COMPLETED", "no merge")
        self.assert_same_tables(expected)

    def test_a_task_that_fails_for_good_is_reported(self):
        study = write_study(self.folder, count=20, chunk_points=10, restarts=1)
        wrapper = self.folder / "robomill that fails"
        wrapper.write_text(f"#!/bin/bash\ncase \"$*\" in *\"--shard 2/\"*) echo no disk; exit 1 ;; esac\nexec '{PROGRAM}' \"$@\"\n")
        wrapper.chmod(0o755)
        with rig.Cluster() as cluster:
            environment = dict(cluster.environment, ROBOMILL=str(wrapper))
            self.robomill("sweep", study, "-o", self.out, "--slurm", environment=environment)
            self.wait_for_merge(cluster, "FAILED")
            said = self.robomill("sweep", study, "-o", self.out, "--status", environment=environment)
            self.assertIn("3 done, 1 failed", said)
            self.assertIn("task 2: FAILED", said)
            merge = (self.out / "slurm" / "merge.out").read_text()
            self.assertIn("needs all chunks: 6 of 8 are done", merge)
            self.assertIn("task 2: FAILED", merge)
            task = (self.out / "slurm" / "2.out").read_text()
            self.assertEqual(task.count("no disk"), 2, "it was tried again once")
            self.assertIn("it is not tried again", task)
            self.assertFalse((self.out / "results.csv").exists())
            # The program is well again: what is missing is submitted, and no more.
            before = chunks_of(self.out)
            self.robomill("sweep", study, "-o", self.out, "--slurm", environment=cluster.environment)
            self.wait_for_merge(cluster, "COMPLETED")
            self.assertEqual(before, {name: inode for name, inode in chunks_of(self.out).items() if name in before})
        self.assert_same_tables(self.tables_by_threads(study))

    def test_kills_lose_nothing_and_do_nothing_twice(self):
        # A chunk takes some tenths of a second, so that the kills meet work.
        study = write_study(self.folder, count=150, chunk_points=5, speeds=60)
        chunks = 120
        expected = self.tables_by_threads(study)
        seed = int(os.environ.get("ROBOMILL_SEED", "1"))
        choose = random.Random(seed)
        killed, seen = [], {}
        with rig.Cluster() as cluster:
            self.robomill("sweep", study, "-o", self.out, "--slurm", environment=cluster.environment)
            begin = time.monotonic()
            for number in range(KILLS):
                # Spread over the study: each after some more chunks.
                target = (number + 1) * (chunks - 10) // KILLS
                rig.wait_for(lambda target=target: len(chunks_of(self.out)) >= target, f"seed {seed}, after {killed}: no more chunks\n{cluster.logs()}",
                             stalled=cluster.look_again)
                seen.update({name: inode for name, inode in chunks_of(self.out).items() if name not in seen})
                time.sleep(choose.uniform(0, 0.1))
                what = choose.choice(["sweep", "sweep", "slurmctld", *cluster.nodes])
                if what == "slurmctld" and time.monotonic() < begin + 10:
                    what = "sweep"  # the controller itself saves its jobs some seconds after they came
                if what == "sweep":
                    pids = []
                    rig.wait_for(lambda pids=pids: pids.extend(cluster.own_processes(b"--shard")) or pids, "nothing runs", stalled=cluster.look_again)
                    for pid in pids:
                        os.kill(pid, signal.SIGKILL)
                else:
                    cluster.kill(what)
                    time.sleep(choose.uniform(0, 0.5))
                    cluster.start(what)
                killed.append(what)
            try:
                self.wait_for_merge(cluster, "COMPLETED")
            except TimeoutError as error:
                self.fail(f"seed {seed}, after {killed}: {error}\n{cluster.logs()}")
            print(f"{KILLS} kills in {time.monotonic() - begin:.0f} s: {', '.join(f'{killed.count(name)} of {name}' for name in sorted(set(killed)))}")
        self.assert_same_tables(expected)
        there = chunks_of(self.out)
        self.assertEqual(len(there), chunks)
        self.assertEqual(seen, {name: there[name] for name in seen}, "a chunk that was there was written again")
        self.assertEqual([path.name for path in (self.out / "chunks").iterdir() if path.name not in there and not path.name.startswith(".")], [])


if __name__ == "__main__":
    if os.environ.get("ROBOMILL_FULL") != "1":
        print("skipped: ROBOMILL_FULL is not 1")
        sys.exit(77)
    if rig.missing():
        print(f"skipped: no {', '.join(rig.missing())}; tools/install full")
        sys.exit(77)
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main(verbosity=2)
