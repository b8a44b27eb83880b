# SPDX-License-Identifier: BSD-3-Clause
"""Runs a command that makes files, and keeps beside them what it printed and what it took.

  told.py make FOLDER [--copy FILE NAME] -- COMMAND...   {} in its words stands for FOLDER
  told.py tell FOLDER                                     prints it: one JSON object

`said`: the JSON objects that the command printed; `cpu_s`, `peak_rss_bytes`: of the command alone;
`files`: bytes of each file that it made.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TOLD = "told.json"


def objects_in(text):
    decoder, found, at = json.JSONDecoder(), [], 0
    while (at := at + len(text[at:]) - len(text[at:].lstrip())) < len(text):
        each, at = decoder.raw_decode(text, at)
        found += each if isinstance(each, list) else [each]
    return found


def take(command):
    """(exit code, standard output, what the system says it took)"""
    with tempfile.TemporaryFile() as out:
        child = subprocess.Popen(command, stdout=out, stdin=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)  # so that nobody waits for it again
        out.seek(0)
        return child.returncode, out.read().decode(), usage


def make(folder, words):
    folder.mkdir()
    while words[0] == "--copy":
        shutil.copyfile(words[1], folder / words[2])
        words = words[3:]
    code, said, usage = take([word.replace("{}", str(folder)) for word in words[1:]])
    if code != 0:
        shutil.rmtree(folder)
        return code if code > 0 else 128 - code
    files = {path.relative_to(folder).as_posix(): path.stat().st_size
             for path in sorted(folder.rglob("*")) if path.is_file()}
    told = {"said": objects_in(said.replace(str(folder), "")),
            "cpu_s": usage.ru_utime + usage.ru_stime, "peak_rss_bytes": usage.ru_maxrss * 1024,
            "files": files}
    (folder / TOLD).write_text(json.dumps(told), encoding="utf-8")
    return 0


def main():
    verb, folder, *words = sys.argv[1:]
    if verb == "make":
        return make(Path(folder), words)
    print((Path(folder) / TOLD).read_text(encoding="utf-8"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
