# SPDX-License-Identifier: BSD-3-Clause
"""Sections at work: all are measured first, then each gives its tables and figures. A section that
fails costs only itself."""
import traceback
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from frame import files
from frame.cells import exact


@dataclass
class Part:
    """What a section gives. `section`: its module; `command`: what makes it again."""
    name: str
    section: object
    command: str
    tables: list = field(default_factory=list)
    figures: list = field(default_factory=list)
    failure: str = ""

    @property
    def title(self):
        return self.section.TITLE

    def attempt(self, work):
        """Does it unless the section has failed already; a failure is kept and told."""
        if self.failure:
            return
        try:
            work()
        except Exception as error:  # pylint: disable=broad-except
            traceback.print_exc()
            self.failure = f"{type(error).__name__}: {error}"


def measure_all(context, parts, jobs):
    """Fills the store. Sections that take times (TIMED) are measured alone, the others `jobs` at
    once, each with one thread."""
    def work(part):
        context.progress(f"== {part.title}")
        part.attempt(lambda: part.section.measure(context))

    timed = [part for part in parts if getattr(part.section, "TIMED", False)]
    for part in timed:
        work(part)
    with ThreadPoolExecutor(max(jobs, 1)) as pool:
        tasks = [pool.submit(work, part) for part in parts if part not in timed]
        try:
            for task in tasks:
                task.result()
        except BaseException:
            context.stopping = True  # those at work end after the command that they run
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def fill(context, part):
    """Tables, each also as CSV, and figures of what was measured."""
    def work():
        part.tables = part.section.tables(context)
        for table in part.tables:
            table.command = table.command or part.command
            columns = [column.key for column in table.columns]
            files.write_csv(context.out / "tables" / f"{table.id}.csv", columns,
                            [[exact(row[key]) for key in columns] for row in table.rows])
        part.figures = part.section.figures(context)
    part.attempt(work)
