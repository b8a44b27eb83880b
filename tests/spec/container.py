# SPDX-License-Identifier: BSD-3-Clause
"""The container: chunks of a .curl file."""
import struct

MAGIC = b"\x89CURL\r\n"
VERSION = 1
END = 0x00
ONCE = {0x00, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x10, 0x11, 0x12, 0x16, 0x17, 0x20, 0x21,
        0x22, 0x23, 0x24, 0x80, 0x81}
REPEATED = {0x13, 0x14, 0x15}


class Corrupt(Exception):
    """The file breaks a rule of the format."""


class Unsupported(Exception):
    """The file is of a version, or has a critical chunk, that this decoder does not know."""


class Chunk:
    def __init__(self, kind, payload, whole=True):
        self.kind = kind
        self.payload = payload
        self.whole = whole


class Reader:
    """Fields of a payload, one after the other."""

    def __init__(self, data):
        self.data = data
        self.at = 0

    def bytes(self, size):
        if size > len(self.data) - self.at:
            raise Corrupt("a field reaches beyond its payload")
        self.at += size
        return self.data[self.at - size:self.at]

    def u8(self):
        return self.bytes(1)[0]

    def varint(self):
        value = 0
        for place in range(10):
            byte = self.u8()
            value |= (byte & 127) << 7 * place
            if byte < 128:
                if value >> 64:
                    break
                return value
        raise Corrupt("a varint of more than 64 bits")

    def end(self):
        if self.at != len(self.data):
            raise Corrupt("bytes after the last field of a payload")


def _crc_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


_TABLE = _crc_table()


def crc32c(data):
    value = 0xFFFFFFFF
    for byte in data:
        value = _TABLE[(value ^ byte) & 255] ^ value >> 8
    return value ^ 0xFFFFFFFF


def read_chunks(data, cut=False):
    """All chunks but the end; with `cut`, the last one may be there in part."""
    if data[:7] != MAGIC:
        raise Corrupt("not a .curl file")
    if len(data) < 8:
        raise Corrupt("no version")
    if data[7] != VERSION:
        raise Unsupported(f"version {data[7]}")
    chunks, at, seen = [], 8, set()
    while True:
        reader = Reader(data[at:])
        try:
            kind = reader.u8()
            size = reader.varint()
            payload = reader.bytes(size)
            body = data[at:at + reader.at]
            (checksum,) = struct.unpack("<I", reader.bytes(4))
        except Corrupt:
            if not cut:
                raise
            return chunks + _part(data[at:], seen)
        if checksum != crc32c(body):
            raise Corrupt(f"checksum of chunk 0x{kind:02x}")
        check_kind(kind, seen)
        at += reader.at
        if kind == END:
            if payload or at != len(data):
                raise Corrupt("the end is not the end")
            return chunks
        if kind in ONCE | REPEATED:
            chunks.append(Chunk(kind, payload))


def check_kind(kind, seen):
    """Whether a chunk of a kind may follow those seen."""
    if kind in ONCE and kind in seen:
        raise Corrupt(f"chunk 0x{kind:02x} twice")
    if kind not in ONCE | REPEATED and kind < 0x80:
        raise Unsupported(f"chunk 0x{kind:02x}")
    seen.add(kind)


def _part(data, seen):
    """What is left of the payload of a chunk that is cut off."""
    reader = Reader(data)
    try:
        kind = reader.u8()
        size = reader.varint()
    except Corrupt:
        return []
    check_kind(kind, seen)
    return [Chunk(kind, data[reader.at:reader.at + size], whole=False)]


def varint(value):
    text = b""
    while value > 127:
        text += bytes([value & 127 | 128])
        value >>= 7
    return text + bytes([value])


def chunk_bytes(kind, payload):
    body = bytes([kind]) + varint(len(payload)) + payload
    return body + struct.pack("<I", crc32c(body))


def file_of(chunks):
    """The bytes of a file with these (type, payload); for tests."""
    bodies = b"".join(chunk_bytes(kind, payload) for kind, payload in chunks)
    return MAGIC + bytes([VERSION]) + bodies + chunk_bytes(END, b"")
