# SPDX-License-Identifier: BSD-3-Clause
"""Runs a command and says how much CPU time it took."""
import os
import subprocess
import tempfile


class CommandFailed(RuntimeError):
    """A command ended with an error; the message holds its last words."""


def run(command, folder, allowed=(0,)):
    """(standard output, CPU seconds of the command alone), whatever else runs beside it. Scratch
    files lie in `folder`; `allowed`: exit codes that are no failure."""
    with tempfile.TemporaryFile(dir=folder) as out, tempfile.TemporaryFile(dir=folder) as err:
        child = subprocess.Popen([str(part) for part in command], stdout=out, stderr=err,
                                 stdin=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)  # so that nobody waits for it again
        out.seek(0)
        err.seek(0)
        if child.returncode not in allowed:
            lines = err.read().decode(errors="replace").strip().splitlines()
            said = " / ".join(lines[-2:]) or "no message"
            raise CommandFailed(f"{command[1]} ended with {child.returncode}: {said}")
        return out.read().decode(), usage.ru_utime + usage.ru_stime
