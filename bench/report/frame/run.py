# SPDX-License-Identifier: BSD-3-Clause
"""Runs programs and reads the JSON that they print."""
import json
import subprocess


class CommandFailed(RuntimeError):
    """A program could not be run, ended with an error or printed what is not JSON."""


def output_of(command):
    """Standard output of a command; CommandFailed with its last words."""
    texts = [str(part) for part in command]
    try:
        run = subprocess.run(texts, capture_output=True, text=True, check=False,
                             stdin=subprocess.DEVNULL)
    except OSError as error:
        raise CommandFailed(f"{texts[0]} could not be run: {error.strerror}") from error
    if run.returncode != 0:
        said = " / ".join(run.stderr.strip().splitlines()[-2:]) or "no message"
        name = " ".join(part for part in texts[:2] if not part.startswith("-"))
        raise CommandFailed(f"{name} ended with {run.returncode}: {said}")
    return run.stdout


def objects_in(text):
    """The JSON objects of a text, one after the other, on one line each or on many."""
    decoder, found, at = json.JSONDecoder(), [], 0
    while (at := at + len(text[at:]) - len(text[at:].lstrip())) < len(text):
        try:
            each, at = decoder.raw_decode(text, at)
        except ValueError as error:
            raise CommandFailed(f"what was printed is no JSON: {text[at:at + 60]!r}") from error
        if not isinstance(each, dict):
            raise CommandFailed(f"what was printed is no JSON object: {each!r:.60}")
        found.append(each)
    return found

