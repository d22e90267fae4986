# SPDX-License-Identifier: Apache-2.0
"""Waits for states, never for times: all Python tests wait for, run and end programs with this module.

No test may fail because the machine is slow. A test waits for something observable (a file, a line, a title, the end of a
process), however long it takes. PATIENCE_S only ends tests that hang. The CPU time of programs that might run forever is
limited; it does not depend on other programs.

    wait_for("the window", find_window)                   the first true value of find_window()
    wait_for("4 samples", lambda: n() >= 4, seen=n)       a failure also reports what n() was at the end
    run(words, cwd=folder)                                like subprocess.run with captured text
    finish(process)                                       like process.communicate()
    processor_seconds(pid)                                CPU time of a running process
    processor_seconds_of_children()                       CPU time of all children that have ended
"""
import os
import resource
import signal
import subprocess
import time

# The time ends only tests that hang. FATHOM_TEST_PATIENCE shortens it where hangs are expected, such as with planted
# bugs.
PATIENCE_S = float(os.environ.get("FATHOM_TEST_PATIENCE", 1800))
# A limit of hundreds of times what a program under test needs, even with a sanitizer.
PROCESSOR_S = 900
PAUSE_S = 0.05


def last_lines(text, count=40):
    return "\n".join(text.splitlines()[-count:])


def what_is_seen(seen):
    try:
        return seen()
    except Exception as error:  # a closed window has no title
        return f"none ({error})"


def wait_for(what, condition, seen=None, stop=None, pause_s=PAUSE_S):
    """The first true value of condition().

    seen  function that returns the state to report on failure
    stop  function that returns why waiting has become useless (such as an ended process), or a false value
    """
    end = time.monotonic() + PATIENCE_S
    while True:
        # The order matters: a condition that holds after the end of the process must be evaluated after `stop`.
        reason = stop() if stop else None
        value = condition()
        if value:
            return value
        if not reason and time.monotonic() < end:
            time.sleep(pause_s)
            continue
        state = f"; the last state: {what_is_seen(seen)}" if seen else ""
        raise AssertionError(f"waited for {what}, but {reason}{state}" if reason else
                             f"waited {PATIENCE_S:.0f} s in vain for {what}{state}")


def ended(process, name="the program"):
    """Returns an argument `stop` for wait_for() that reports the end of a Popen."""
    return lambda: process.poll() is not None and f"{name} has ended with {process.returncode}"


def limit_processor_time(process, seconds=PROCESSOR_S):
    """Ends programs that never end by themselves, but not those that are slow under load; None: no limit. Each child
    process has a limit of its own."""
    if seconds is None:
        return
    try:
        resource.prlimit(process.pid, resource.RLIMIT_CPU, (seconds, seconds + 10))
    except (ProcessLookupError, PermissionError):
        pass  # it has ended, or changed its user


def finish(process, words="the program"):
    """Returns (stdout, stderr) of a Popen once it has ended."""
    try:
        said = process.communicate(timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        said = process.communicate()
        text = "\n".join(last_lines(part if isinstance(part, str) else part.decode(errors="replace")) for part in said if part)
        raise AssertionError(f"waited {PATIENCE_S:.0f} s in vain for {words} to end; it printed last: {text}") from None
    except BaseException:
        process.kill()
        process.wait()
        raise
    if process.returncode == -signal.SIGXCPU:
        raise AssertionError(f"{words} used more than its limit of processor time")
    return said


def run(words, processor_s=PROCESSOR_S, text=True, **options):
    """Like subprocess.run, with stdout and stderr captured unless they are given."""
    words = [os.fspath(word) for word in words]
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    check = options.pop("check", False)
    process = subprocess.Popen(words, text=text, **options)
    limit_processor_time(process, processor_s)
    stdout, stderr = finish(process, " ".join(words))
    result = subprocess.CompletedProcess(words, process.returncode, stdout, stderr)
    if check and result.returncode != 0:
        raise AssertionError(f"{' '.join(words)}: exit code {result.returncode}: {stdout}{stderr}")
    return result


def processor_seconds(pid):
    """CPU time of a running process in seconds, the sum of all its threads."""
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def processor_seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def has_signal(pid, kind, number):
    """Whether a mask of /proc/PID/status, such as SigCgt (has a handler) or ShdPnd (pending), contains a signal."""
    try:
        with open(f"/proc/{pid}/status") as file:
            masks = dict(line.split(":", 1) for line in file)
        return bool(int(masks[kind], 16) >> (number - 1) & 1)
    except (OSError, KeyError):
        return False


def state_of(pid):
    """State letter of /proc/PID/stat: R, S, T (stopped), Z (ended, but not waited for); X if there is no such process."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0]
    except OSError:
        return "X"


def is_running(pid):
    """Whether a process exists and has not ended; it need not be a child of this one."""
    return state_of(pid) not in "ZX"


def stop(pid):
    """Stops a process until SIGCONT and returns False if it has ended. It may handle other signals until it stops."""
    try:
        os.kill(pid, signal.SIGSTOP)
    except ProcessLookupError:
        return False
    wait_for("the process to stop", lambda: state_of(pid) in "TZX", pause_s=0.01)
    return is_running(pid)
