# SPDX-License-Identifier: BSD-3-Clause
"""Sequences (docs/format/curl-sequence-1.md)."""
from cloud_file import ORDER, CloudFile
from container import END, REPEATED, Corrupt, Reader, Unsupported, file_of, read_chunks
from indexed import PART, IndexedFile, need
from predicted import PREDICTION, PredictedScan
from scan import Scan

FIRST, ALONE, PREDICTED = range(3)
AS_BEFORE = 0x40
MOST_SCANS, MOST_RETURNS = 1 << 16, 1 << 40
ENDS = 1 << 62
SECOND = 10 ** 9


def zigzag(reader):
    told = reader.varint()
    return -(told >> 1) - 1 if told & 1 else told >> 1


class Course:
    """Numbers that go on as they did, in 64 bits that wrap around."""

    def __init__(self, most):
        self.most, self.told = most, []

    def next(self, reader):
        told = self.told
        expected = 2 * told[-1] - told[-2] if len(told) > 1 else told[0] if told else 0
        value = (expected + zigzag(reader) + (1 << 63)) % (1 << 64) - (1 << 63)
        need(abs(value) <= self.most, "a number out of its bounds")
        told.append(value)
        return value


def seconds(time):
    if abs(time) < 1 << 53:
        return time / SECOND
    return float(time // SECOND) + float(time % SECOND) / float(SECOND)


def rotation(w, x, y, z):
    square = float(w * w + x * x + y * y + z * z)
    if not square:
        return [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    s = 2 / square
    return [[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]]


class Frame:
    """A scan of a group: returns, time (s), place (m) and rotation, or None; kind, bytes."""

    def __init__(self):
        self.returns, self.bytes = 0, b""
        self.time = self.place = self.rotation = None

    @property
    def kind(self):
        need(self.bytes and self.bytes[0] <= PREDICTED, "no kind of frame")
        return self.bytes[0]


def read_group(payload):
    """The number of the first scan, and the frames."""
    reader = Reader(payload)
    flags, first, count = reader.u8(), reader.varint(), reader.varint()
    need(flags < 4 and 1 <= count <= MOST_SCANS and first <= MOST_RETURNS, "the head of a group")
    need(count <= len(payload), "more scans than bytes")
    frames, returns = [Frame() for _ in range(count)], 0
    for frame in frames:
        returns += zigzag(reader)
        need(0 <= returns <= MOST_RETURNS, "a number of returns")
        frame.returns = returns
    sizes = [reader.varint() for _ in frames[1:]]
    if flags & 1:
        times = Course(ENDS)
        for frame in frames:
            frame.time = seconds(times.next(reader))
    if flags & 2:
        courses = [Course(ENDS) for _ in range(3)] + [Course(1 << 30) for _ in range(4)]
        for frame in frames:
            values = [course.next(reader) for course in courses]
            frame.place = [value / 2 ** 20 for value in values[:3]]
            frame.rotation = rotation(*values[3:])
    for number, frame in enumerate(frames):
        last = number == len(frames) - 1
        frame.bytes = reader.bytes(len(payload) - reader.at if last else sizes[number])
        need((frame.kind == FIRST) == (number == 0), "one first frame, and that in front")
    return first, frames


def file_of_frame(data, memory):
    """The scan's file as it was; `memory` holds the last payload of each type."""
    reader = Reader(data)
    if reader.u8() == FIRST:
        memory.clear()
    chunks, seen = [], set()
    while reader.at < len(data):
        named = reader.u8()
        kind = named & ~AS_BEFORE
        need(kind != END and not (kind in seen and may_not_repeat(kind)), "a chunk out of place")
        seen.add(kind)
        if named & AS_BEFORE:
            need(may_not_repeat(kind) and kind in memory, "nothing to take over")
            payload = memory[kind]
        else:
            size = reader.varint()
            payload = reader.bytes(size - 1 if size else len(data) - reader.at)
            if may_not_repeat(kind):
                memory[kind] = payload
        chunks.append((kind, payload))
    return file_of(chunks)


def may_not_repeat(kind):
    return kind not in REPEATED and kind != PART


class Sequence(IndexedFile):
    """Group size, whether the sensor stood still; scans by their number."""

    KIND = 2

    def _header(self, payload):
        reader = Reader(payload)
        flags, self.group = reader.u8(), reader.varint()
        if flags > 1:
            raise Unsupported("flags of a later version")
        need(1 <= self.group <= MOST_SCANS, "the size of the groups")
        self.still = bool(flags)
        reader.end()

    def summary(self, reader):
        scans, returns = reader.varint(), reader.varint()
        need(1 <= scans <= MOST_SCANS and returns <= 1 << 48, "a summary")
        time = zigzag(reader) if reader.at < len(reader.data) else None
        return {"scans": scans, "returns": returns, "time": time}

    def frames(self, number):
        """The frames of a group, which must be those that the index tells."""
        first, frames = read_group(self.part(number))
        before = sum(entry[2]["scans"] for entry in self.entries[:number])
        need(first == before and len(frames) == self.entries[number][2]["scans"],
             "other scans than the index tells")
        return frames

    def files(self, number):
        """The files of a group's scans."""
        memory = {}
        return [file_of_frame(frame.bytes, memory) for frame in self.frames(number)]

    def scans(self, number):
        """The decoded scans of a group: Scan, PredictedScan, or CloudFile of every return."""
        decoded, before = [], None
        for frame, data in zip(self.frames(number), self.files(number)):
            kinds = {chunk.kind for chunk in read_chunks(data)}
            if (frame.kind == PREDICTED) != (PREDICTION in kinds):
                raise Corrupt("a kind that the chunks do not have")
            if frame.kind == PREDICTED:
                scan = PredictedScan(data, before)
            else:
                scan = CloudFile(data) if ORDER in kinds else Scan(data)
            before = scan.scan if isinstance(scan, CloudFile) else scan
            decoded.append(scan)
        return decoded
