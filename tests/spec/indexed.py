# SPDX-License-Identifier: BSD-3-Clause
"""Files of many parts (docs/format/curl-format-1-indexed.md), and what both kinds of maps share
(curl-map-file-1.md)."""
import struct

from container import END, MAGIC, VERSION, Corrupt, Reader, Unsupported, crc32c

HEADER, PART, INDEX, FOOTER = 0x30, 0x31, 0x32, 0x33
FAR = 1e12


def chunk_at(data, at):
    """(type, payload, where the next one starts) of the chunk at a place, its checksum held."""
    reader = Reader(data[at:])
    kind = reader.u8()
    payload = reader.bytes(reader.varint())
    body = data[at:at + reader.at]
    (checksum,) = struct.unpack("<I", reader.bytes(4))
    if checksum != crc32c(body):
        raise Corrupt(f"checksum of chunk 0x{kind:02x}")
    return kind, payload, at + reader.at


def expect(data, at, kind):
    found, payload, after = chunk_at(data, at)
    if found != kind:
        raise Corrupt(f"chunk 0x{found:02x} instead of 0x{kind:02x}")
    return payload, after


def numbers(reader, form):
    return list(struct.unpack("<" + form, reader.bytes(struct.calcsize("<" + form))))


def need(condition, what):
    if not condition:
        raise Corrupt(what)


class IndexedFile:
    """A whole file: its header, and for each part where it lies, its size and its summary."""

    KIND = None

    def __init__(self, data):
        need(data[:7] == MAGIC, "not a .curl file")
        if data[7] != VERSION:
            raise Unsupported(f"version {data[7]}")
        self.data = data
        header, first = expect(data, 8, HEADER)
        if header[0] != self.KIND:
            raise Unsupported(f"an indexed file of kind {header[0]}")
        self._header(header[1:])
        payload, end = expect(data, len(data) - 6, END)
        need(payload == b"" and end == len(data), "the end")
        footer, after = expect(data, len(data) - 28, FOOTER)
        need(len(footer) == 16 and after == len(data) - 6, "the footer")
        begin, size = struct.unpack("<QQ", footer)
        index, after = expect(data, begin, INDEX)
        need(after - begin == size and after == len(data) - 28, "the index lies elsewhere")
        self._index(index, first, begin)

    def _index(self, payload, first, begin):
        reader = Reader(payload)
        self.entries, at = [], first
        for _ in range(reader.varint()):
            size = reader.varint()
            summary = Reader(reader.bytes(reader.varint()))
            self.entries.append((at, size, self.summary(summary)))
            summary.end()
            varint_bytes = max(1, (size.bit_length() + 6) // 7)
            at += 1 + varint_bytes + size + 4
        reader.end()
        need(at == begin, "the index adds up to another place")

    def part(self, number):
        at, size, _ = self.entries[number]
        payload, _ = expect(self.data, at, PART)
        need(len(payload) == size, "a part of another size")
        return payload


class MapFile(IndexedFile):
    """A map: what the headers of both kinds have."""

    def _header(self, payload):
        reader = Reader(payload)
        self.origin = numbers(reader, "3d")
        self.min_range, self.max_range = numbers(reader, "2d")
        self.scans = reader.varint()
        (self.way,) = numbers(reader, "d")
        need(all(abs(x) <= FAR for x in self.origin), "the origin")
        need(0 <= self.min_range <= self.max_range <= 1e6, "ranges")
        need(0 <= self.way <= 1e15, "the way")
        self.header_of_kind(reader)
        self.metadata = {}
        for _ in range(reader.varint()):
            key, value = (reader.bytes(reader.varint()).decode("utf-8") for _ in range(2))
            need(key, "an empty key")
            self.metadata[key] = value
        reader.end()

    def header_of_kind(self, reader):
        """What the header of this kind alone has."""
