# SPDX-License-Identifier: Apache-2.0
"""A real Slurm on this machine, with several nodes of one processor each: sbatch, arrays, requeue, lost nodes.

All its files are in a folder of its own; it needs no root, no systemd and no host name. Intervals are short, so that
tests need not wait for minutes. Time limits for daemons and tasks are long, because a busy machine must behave like an
idle one.
"""
import getpass
import os
import shutil
import signal
import socket
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
import waiting  # noqa: E402

SBIN = os.pathsep.join(["/usr/local/sbin", "/usr/sbin", "/sbin"])
DAEMONS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "srun", "scancel")


def missing_program():
    """Returns the first of Slurm's programs that is not installed, or None."""
    path = os.environ["PATH"] + os.pathsep + SBIN
    return next((name for name in DAEMONS if not shutil.which(name, path=path)), None)


def why_none_comes_up():
    """Returns None if a cluster of one node can be started, else the error."""
    with tempfile.TemporaryDirectory(prefix="fathom-slurm-", ignore_cleanup_errors=True) as folder:
        cluster = Slurm(folder, nodes=1)
        try:
            cluster.start()
        except (RuntimeError, AssertionError) as error:
            return str(error).replace("\n", " ")
        finally:
            cluster.stop()
    return None


def free_ports(count):
    held = []
    for _ in range(count):
        held.append(socket.socket())
        held[-1].bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in held]
    for s in held:
        s.close()
    return ports


class Slurm:
    def __init__(self, folder, nodes=4, max_array_size=64, hidden=None):
        """hidden: a folder that the nodes don't see, if this process may hide one from them."""
        self.folder, self.nodes, self.hidden = folder, nodes, hidden
        for name in ("log", "state", "spool", "munge"):
            os.makedirs(os.path.join(folder, name), mode=0o700)
        self.conf = os.path.join(folder, "slurm.conf")
        path = os.environ["PATH"] + os.pathsep + SBIN
        self.environment = {**os.environ, "SLURM_CONF": self.conf, "PATH": os.path.join(folder, "bin") + os.pathsep + path}
        self.write_settings(max_array_size)
        self.write_patient_srun(shutil.which("srun", path=path))

    def write_patient_srun(self, srun):
        """Wraps srun. Fathom requests a node immediately, and continues without one if none is free; with the wrapper
        it waits for a node."""
        os.mkdir(os.path.join(self.folder, "bin"))
        wrapper = os.path.join(self.folder, "bin", "srun")
        with open(wrapper, "w") as file:
            file.write(f'#!/bin/bash\nexec {srun} "${{@/#--immediate=*/--immediate=3600}}"\n')
        os.chmod(wrapper, 0o755)

    def write_settings(self, max_array_size):
        me, f = getpass.getuser(), self.folder
        control, *node_ports = free_ports(1 + self.nodes)
        lines = {
            "ClusterName": f"fathom{control}", "SlurmctldHost": "localhost(127.0.0.1)", "SlurmctldPort": control,
            "SlurmUser": me, "SlurmdUser": me, "StateSaveLocation": f"{f}/state", "SlurmdSpoolDir": f"{f}/spool/%n",
            "TmpFS": f"{f}/spool/%n", "SlurmctldPidFile": f"{f}/slurmctld.pid", "SlurmdPidFile": f"{f}/slurmd-%n.pid",
            "SlurmctldLogFile": f"{f}/log/slurmctld.log", "SlurmdLogFile": f"{f}/log/slurmd-%n.log",
            # A requeued task waits until its credentials expire, and a task that starts later than that fails.
            "AuthInfo": f"socket={f}/munge/socket,cred_expire=30",
            "ProctrackType": "proctrack/linuxproc", "TaskPlugin": "task/none", "JobAcctGatherType": "jobacct_gather/none",
            "AccountingStorageType": "accounting_storage/none", "JobCompType": "jobcomp/none", "MailProg": "/bin/true",
            "SelectType": "select/cons_tres", "SelectTypeParameters": "CR_Core", "SlurmdParameters": "config_overrides",
            "JobRequeue": 1, "MinJobAge": 10, "ReturnToService": 1,
            # These limits on the start and end of tasks and on answers of daemons are reached only if something is
            # wrong.
            "KillWait": 300, "BatchStartTimeout": 600, "SlurmdTimeout": 3600, "SlurmctldTimeout": 3600, "MessageTimeout": 30,
            "TCPTimeout": 30, "UnkillableStepTimeout": 600, "PropagateResourceLimits": "NONE",
            "MaxArraySize": max_array_size, "SchedulerParameters": "sched_interval=2,bf_interval=2,batch_sched_delay=0",
        }
        with open(self.conf, "w") as file:
            for name, value in lines.items():
                file.write(f"{name}={value}\n")
            for number, port in enumerate(node_ports, 1):
                file.write(f"NodeName=n{number} NodeHostname=localhost NodeAddr=127.0.0.1 Port={port} CPUs=1 State=UNKNOWN\n")
            file.write(f"PartitionName=main Nodes=n[1-{self.nodes}] Default=YES DefaultTime=10 MaxTime=INFINITE State=UP\n")

    def start(self):
        key = os.path.join(self.folder, "munge/key")
        with open(os.open(key, os.O_CREAT | os.O_WRONLY, 0o400), "wb") as file:
            file.write(os.urandom(1024))
        m = os.path.join(self.folder, "munge")
        self.run("munged", f"--key-file={key}", f"--socket={m}/socket", f"--pid-file={m}/munged.pid",
                 f"--log-file={m}/munged.log", f"--seed-file={m}/munged.seed", "--force")
        self.start_controller()
        for number in range(1, self.nodes + 1):
            self.start_node(number)
        self.wait_for("all nodes to be idle", lambda: self.ask("sinfo", "-h", "-N", "-o", "%T").split() == ["idle"] * self.nodes)

    def start_controller(self):
        self.run("slurmctld", "-f", self.conf)

    def start_node(self, number):
        command = ["slurmd", "-f", self.conf, "-N", f"n{number}"]
        if self.hidden:
            words = " ".join(command)
            command = ["unshare", "--mount", "sh", "-c", f"mount -t tmpfs none '{self.hidden}' && exec {words}"]
        self.run(*command)

    def kill_controller(self):
        with open(os.path.join(self.folder, "slurmctld.pid")) as file:
            os.kill(int(file.read()), signal.SIGKILL)

    def stop(self):
        """Ends all jobs and daemons."""
        self.ask("scancel", "--user", getpass.getuser())
        pids = {"munge/munged.pid": signal.SIGTERM, "slurmctld.pid": signal.SIGKILL}
        pids.update({f"slurmd-n{number}.pid": signal.SIGKILL for number in range(1, self.nodes + 1)})
        # A command that fails counts as an empty queue.
        waiting.wait_for("the queue to be empty", lambda: not self.ask("squeue", "-h"), pause_s=0.5)
        told = []
        for name, how in pids.items():
            try:
                with open(os.path.join(self.folder, name)) as file:
                    pid = int(file.read())
                os.kill(pid, how)
                told.append(pid)
            except (OSError, ValueError):
                pass
        # munged writes its seed when it ends, so the folder must not be removed earlier.
        waiting.wait_for("the daemons to end", lambda: not any(map(waiting.is_running, told)))

    def run(self, *words):
        # Daemons inherit the limits of this process, so there is no limit of processor time.
        result = waiting.run(words, env=self.environment, processor_s=None)
        if result.returncode != 0:
            raise RuntimeError(f"{words[0]}: {result.stderr.strip()}")
        return result.stdout

    def ask(self, *words):
        """Returns the output of a command of Slurm; empty if it fails."""
        result = waiting.run(words, env=self.environment)
        return result.stdout if result.returncode == 0 else ""

    def wait_for(self, what, is_so, seen=None, stop=None):
        def state():
            with open(os.path.join(self.folder, "log/slurmctld.log"), errors="replace") as file:
                return (f"{seen() if seen else ''}\nthe queue:\n{self.ask('squeue', '-o', '%i %T %r %S')}"
                        f"the controller's last lines:\n{file.read()[-2000:]}")
        return waiting.wait_for(what, is_so, seen=state, stop=stop, pause_s=0.3)

    def wait_until_saved(self, job):
        """Waits until the controller has saved the state of all jobs, because a killed one forgets later changes. A
        comment on a waiting job shows what was saved."""
        mark = f"saved-{time.time_ns()}"
        self.run("scontrol", "update", f"JobId={job}", f"Comment={mark}")

        def is_saved():
            with open(os.path.join(self.folder, "state/job_state"), "rb") as file:
                return mark.encode() in file.read()
        self.wait_for("the controller to save its jobs", is_saved)
