# SPDX-License-Identifier: BSD-3-Clause
"""What was measured, one file of JSON lines for each section."""
import json
import threading

from frame import files


def read(line):
    """A record, or None for a line that somebody has torn: it is measured again."""
    try:
        record = json.loads(line)
        return record if record["digest"] and record["lines"] else None
    except (ValueError, KeyError, TypeError):
        return None


class Store:
    """Records by their digest. A record with a failure is kept for the tables of its run only."""

    def __init__(self, folder):
        self.folder, self.records, self.used = folder, {}, {}
        self.measured = self.reused = 0
        self.lock = threading.RLock()

    def section(self, name):
        if name not in self.records:
            self.records[name] = {}
            path = self.path(name)
            if path.is_file():
                for record in map(read, path.read_text(encoding="utf-8").splitlines()):
                    if record:
                        self.records[name][record["digest"]] = record
        return self.records[name]

    def path(self, name):
        return self.folder / f"{name}.jsonl"

    def get(self, name, digest):
        """The lines stored, or None. They count as used in this run."""
        with self.lock:
            record = self.section(name).get(digest)
            if record is None:
                return None
            if digest not in self.used.setdefault(name, {}):
                self.reused += 1
            self.used[name][digest] = record
            return record["lines"]

    def add(self, name, digest, key, command, lines):
        record = {"digest": digest, "key": key, "command": command, "lines": lines}
        with self.lock:
            self.used.setdefault(name, {})[digest] = record
            if any("failure" in line for line in lines):
                return
            self.measured += 1
            self.section(name)[digest] = record
            files.write(self.path(name), "".join(
                json.dumps(each) + "\n" for each in self.records[name].values()))

    def failed(self, name, digest):
        """The lines of a measurement that failed in this run, or None."""
        record = self.used.get(name, {}).get(digest)
        return record and record["lines"]

    def rows(self, name):
        """The lines measured or found again in this run, each with its key (which wins)."""
        return [{**line, **record["key"]}
                for record in self.used.get(name, {}).values() for line in record["lines"]]

    def lines(self, name):
        """The same as they were printed."""
        return [line for record in self.used.get(name, {}).values() for line in record["lines"]]

    def failures(self):
        return [f"{name} {record['key']}: {line['failure']}"
                for name, records in self.used.items() for record in records.values()
                for line in record["lines"] if "failure" in line]
