"""A Slurm cluster of this machine alone, for tests: munged, slurmctld and slurmd in a folder of their own, on loopback, by the user
who runs the tests. Each node is a slurmd of its own; nothing of the machine's own Slurm is read or changed."""
import os
import pathlib
import pwd
import shutil
import signal
import socket
import subprocess
import tempfile
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel"]
CONFIG = """\
ClusterName=robomill
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
JobRequeue=1
SlurmctldTimeout=10
SlurmdTimeout=30
MessageTimeout=5
KillWait=2
SchedulerParameters=sched_interval=2,bf_interval=2
{nodes}
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """Programs that are not there."""
    return [name for name in PROGRAMS if shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin") is None]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def wait_for(condition, what, seconds=120.0, stalled=None):
    """Waits until it is so, which only a fault lets take long. Every ten seconds stalled() is called."""
    begin = help_at = time.monotonic()
    while not condition():
        now = time.monotonic()
        if now > begin + seconds:
            raise TimeoutError(what)
        if stalled is not None and now > help_at + 10:
            help_at = now
            stalled()
        time.sleep(0.1)


class Cluster:
    """`with Cluster(nodes=2) as cluster:`; `cluster.environment` is that of its users."""

    def __init__(self, nodes=2, cpus=1):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="robomill-slurm-"))
        self.folder.chmod(0o755)  # of the way to munge's socket
        self.nodes = [f"n{i + 1}" for i in range(nodes)]
        self.environment = dict(os.environ, PATH=os.environ["PATH"] + ":/usr/sbin", SLURM_CONF=str(self.folder / "slurm.conf"))
        self.processes = {}
        controller, *ports = free_ports(nodes + 1)
        host = socket.gethostname().split(".")[0]
        lines = [f"NodeName={name} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs={cpus} RealMemory=1000 State=UNKNOWN"
                 for name, port in zip(self.nodes, ports)]
        (self.folder / "slurm.conf").write_text(CONFIG.format(host=host, controller=controller, folder=self.folder, nodes="\n".join(lines),
                                                              user=pwd.getpwuid(os.getuid()).pw_name))
        for name, mode in [("state", 0o700), ("munge", 0o755), *((node, 0o755) for node in self.nodes)]:
            (self.folder / name).mkdir(mode=mode)

    def command(self, name):
        folder = self.folder
        if name == "munged":
            return ["munged", "--foreground", "--force", f"--key-file={folder}/key", f"--socket={folder}/munge/socket", f"--pid-file={folder}/munge.pid",
                    f"--log-file={folder}/munge.log", f"--seed-file={folder}/seed", "--num-threads=2"]
        return ["slurmctld", "-D"] if name == "slurmctld" else ["slurmd", "-D", "-N", name]

    def start(self, name):
        with open(self.folder / f"{name}.said", "ab") as said:
            self.processes[name] = subprocess.Popen(self.command(name), env=self.environment, stdin=subprocess.DEVNULL, stdout=said, stderr=said)

    def kill(self, name):
        """As kill -9 does."""
        self.processes[name].kill()
        self.processes[name].wait()

    def __enter__(self):
        key = self.folder / "key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        try:
            self.start("munged")
            wait_for((self.folder / "munge" / "socket").exists, "munged does not begin")
            for name in ["slurmctld", *self.nodes]:
                self.start(name)
            wait_for(lambda: self.ask("sinfo", "--noheader", "--format=%T").split() == ["idle"], "the nodes do not begin")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *what):
        for process in self.processes.values():
            process.kill()
            process.wait()
        for pid in self.own_processes():  # jobs and what watches them
            os.kill(pid, signal.SIGKILL)
        shutil.rmtree(self.folder, ignore_errors=True)

    def own_processes(self, word=b""):
        """Processes that were started in this cluster, of those that have a word in their command line."""
        mark = f"SLURM_CONF={self.folder}/slurm.conf".encode()
        found = []
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit() or int(entry.name) == os.getpid():
                continue
            try:
                if mark in (entry / "environ").read_bytes() and word in (entry / "cmdline").read_bytes():
                    found.append(int(entry.name))
            except OSError:  # it has ended
                pass
        return found

    def ask(self, *words):
        """What a program of the cluster prints; empty where it fails, as while the controller is away."""
        done = subprocess.run(words, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        return done.stdout if done.returncode == 0 else ""

    def look_again(self):
        """What an administrator does after a crash. Nodes report their jobs now: one that was lost while it was launched is found by
        that, else minutes later. A controller that forgot that a job ran launches it again, holds it and drains the node, where it
        finds it running."""
        self.ask("scontrol", "reconfigure")
        for node in self.nodes:
            self.ask("scontrol", "update", f"nodename={node}", "state=resume")
        for line in self.ask("squeue", "--noheader", "--array", "--states=pending", "--format=%A %r").splitlines():
            job, reason = line.split(" ", 1)
            if "held" in reason.lower():
                self.ask("scontrol", "release", job)

    def logs(self):
        return "\n".join(f"== {path.name}\n{path.read_text(errors='replace')[-3000:]}" for path in sorted(self.folder.glob("*.log")))
