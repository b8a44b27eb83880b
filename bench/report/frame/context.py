# SPDX-License-Identifier: BSD-3-Clause
"""What a section is given: where things are, what is measured, and the store."""
import json
import shutil
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from common.digest import digest
from frame import files, run
from frame.cells import Published
from frame.scans import Scene
from frame.store import Store

OUTPUT = object()  # stands in a command of made() for the file that it makes


@dataclass(frozen=True)
class Made:
    """A file, or a folder, that a command makes when it is first needed. Its name tells what made
    it."""
    path: Path
    command: tuple


@dataclass(frozen=True)
class Inside:
    """Files of a folder that is made: all that match a pattern, in the order of their names. As
    part of a command one argument each. `span`: which of them, as a slice."""
    folder: Made
    pattern: str
    span: tuple = (None, None)


class Stopped(BaseException):
    """Somebody stopped the run: nothing more is started."""


class Context:
    """`out`: the report's folder. `scratch`: files of this run, removed when it is complete.
    `curlidar`: the command. `bin`: folder of report_measure and rate_distortion.
    `scans`, `scenes`: real and simulated input. `published`: published.toml as it is. `left_out`:
    folder of confidence taught without a group of scans each, or None."""

    def __init__(self, out, curlidar, bin_folder, scans, scenes, published, quick=False,
                 every=False, left_out=None):
        self.out, self.scratch = out, out / "scratch"
        self.curlidar, self.bin = curlidar, bin_folder
        self.scans, self.scenes, self.published = scans, scenes, published
        self.quick, self.every, self.left_out = quick, every, left_out
        self.store = Store(out / "measurements")
        self.stopping, self._started = False, time.monotonic()
        self._digests, self._making, self._lock = {}, {}, threading.Lock()

    @property
    def inputs(self):
        """Real scans, then simulated scenes. Both have `name`, `sensor` and `id`."""
        return [*self.scans, *self.scenes]

    def measure(self, section, key, command):
        """The objects that a command prints; not run again when the same programs have measured the
        same files already. The command shall use one thread. A file of the command is given as a
        Path, a file that must be made first as Made. A command that fails gives
        [{"failure": why}] and is tried again in the next run only."""
        name = self._digest(json.dumps(key, sort_keys=True), command)
        lines = self.store.get(section, name)
        if lines is None and (lines := self.store.failed(section, name)) is None:
            self.progress(f"{section}: " + ", ".join(str(value) for value in key.values()))
            lines = self._lines(command)
            said = [part.name if isinstance(part, Path) else str(part)
                    for part in map(self._plain, command)]
            self.store.add(section, name, key, " ".join(said), lines)
        return lines

    def measured(self, section):
        """What was measured or found again in this run: the lines, each with its key."""
        return self.store.rows(section)

    def made(self, ending, command):
        """A file of scratch that a command makes, OUTPUT standing for its path; nothing is run
        before it is needed. `ending`: such as '.curl'."""
        return Made(self.scratch / (self._digest("made", command) + ending), tuple(command))

    def made_text(self, ending, text):
        """A file of scratch that holds a text: input of a command."""
        return files.write(self.scratch / (digest("text", text) + ending), text)

    def make(self, made):
        """The path of a file that must be there now; raises run.CommandFailed."""
        with self._lock:
            making = self._making.setdefault(made.path, threading.Lock())
        with making:  # sections that need it at once make it once
            if not made.path.exists():
                self.scratch.mkdir(parents=True, exist_ok=True)
                part = made.path.with_name("part-" + made.path.name)  # keeps the ending
                self._run([word for each in made.command for word in
                           ([part] if each is OUTPUT else self._ready(each))])
                part.replace(made.path)
        return made.path

    def cloud(self, item):
        """The cloud of a scan, or of a scene, which is simulated when it is needed."""
        if not isinstance(item, Scene):
            return item.path
        return self.made(".pcd", [
            self.curlidar, "simulate", "--scene", item.name, "--sensor", item.sensor, "--seed",
            str(item.seed), "--threads", "1", "--quiet", "-o", OUTPUT])

    def published_rows(self, table, **wanted):
        """Rows of published.toml whose texts are as wanted. Numbers come as Published."""
        sources = self.published["sources"]
        rows = []
        for row in self.published.get(table, []):
            if all(row.get(key) == value for key, value in wanted.items()):
                source = sources[row["source"]]
                rows.append({key: Published(value, source)
                             if isinstance(value, (int, float)) and not isinstance(value, bool)
                             else value for key, value in row.items() if key != "source"})
        return rows

    def write_data(self, name, columns, rows):
        """Plain CSV for curves and pictures: data/NAME.csv."""
        return files.write_csv(self.out / "data" / f"{name}.csv", columns, rows)

    def read_data(self, name):
        return files.read_csv(self.out / "data" / f"{name}.csv")

    def figure_path(self, name, kind):
        """Where a figure is drawn to; its folder is there."""
        path = self.out / "figures" / f"{name}.{kind}"
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def progress(self, text):
        """One line on standard error, with minutes and seconds since the start."""
        minutes, seconds = divmod(int(time.monotonic() - self._started), 60)
        print(f"{minutes:3}:{seconds:02} {text}", file=sys.stderr, flush=True)

    def clean(self):
        shutil.rmtree(self.scratch, ignore_errors=True)

    def _run(self, command):
        if self.stopping:
            raise Stopped
        output = run.output_of(command)
        if self.stopping:  # what was interrupted may have ended as if it were complete
            raise Stopped
        return output

    def _lines(self, command):
        """The objects that a command prints, or [{"failure": why}]."""
        try:
            found = run.objects_in(self._run([word for part in command
                                              for word in self._ready(part)]))
            return found or [{"failure": "nothing was printed"}]
        except run.CommandFailed as error:
            if self.stopping:
                raise Stopped from error
            return [{"failure": str(error)}]

    def files_inside(self, inside):
        """Paths of the files, which are there; raises run.CommandFailed if there are none."""
        found = sorted(self.make(inside.folder).glob(inside.pattern))[slice(*inside.span)]
        if not found:
            raise run.CommandFailed(f"no file {inside.pattern} was made")
        return found

    def _ready(self, part):
        """The words that stand for a part of a command, whose files are there."""
        if isinstance(part, Inside):
            return self.files_inside(part)
        return [self.make(part) if isinstance(part, Made) else part]

    def _plain(self, part):
        if isinstance(part, Inside):
            return Path(part.pattern)
        return part.path if isinstance(part, Made) else part

    def _digest(self, first, command):
        parts = [first]
        for part in command:
            if isinstance(part, Made):
                parts.append(part.path.name)
            elif isinstance(part, Inside):
                parts.append(f"{part.folder.path.name}/{part.pattern} {part.span}")
            elif isinstance(part, Path):
                parts.append(self._digest_of_file(part) if part.is_file() else part.name)
            else:
                parts.append("OUTPUT" if part is OUTPUT else str(part))
        return digest(*parts)

    def _digest_of_file(self, path):
        if path not in self._digests:
            self._digests[path] = digest(path)
        return self._digests[path]
