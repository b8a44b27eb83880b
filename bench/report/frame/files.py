# SPDX-License-Identifier: BSD-3-Clause
"""Files are written beside their place and then renamed: they are whole or not there."""
import csv
import io


def write(path, content):
    """`content`: text or bytes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    part.write_bytes(content.encode() if isinstance(content, str) else content)
    part.replace(path)
    return path


def write_csv(path, columns, rows):
    """`rows`: dicts or sequences in the order of the columns."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        values = [row[column] for column in columns] if isinstance(row, dict) else row
        writer.writerow([f"{value:.6g}" if isinstance(value, float) else value for value in values])
    return write(path, text.getvalue())


def read_csv(path):
    """The rows as dicts; what reads as a number is one."""
    with open(path, encoding="utf-8", newline="") as file:
        return [{key: as_number(value) for key, value in row.items()}
                for row in csv.DictReader(file)]


def as_number(text):
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text
