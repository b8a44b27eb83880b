# SPDX-License-Identifier: BSD-3-Clause
"""The records chunk: attributes of every slot."""
import struct

from container import Corrupt, Reader
from entropy import RangeDecoder, decide
from integers import clip
from levels import Levels
from adaptive import SignedNumbers, model, plain_number, unzigzag, wrapped
from order import POINT, Grid, block, join_planes

# The letters of struct by type of values.
TYPES = "bBhHiIqQfd"
DIVISORS = (1, 10, 100, 1000, 10**4, 10**5, 10**6, 255, 65535)
BITS = 9


class Part:
    """Slots that are records of a grid; `records` are those of the slots."""

    def __init__(self, slots, records, grid):
        self.slots, self.records, self.grid = slots, records, grid


class Attributes:
    """Decodes on construction: `attributes`, lists of name, type, components and the bits of all
    values in the order of the slots."""

    def __init__(self, payload, order, grid):
        self.slots = len(order.kinds)
        points = [slot for slot, kind in enumerate(order.kinds) if kind == POINT]
        others = [slot for slot, kind in enumerate(order.kinds) if kind != POINT]
        self.parts = []
        if points:
            self.parts.append(Part(points, order.record, grid))
        if others:
            self.parts.append(Part(others, range(len(others)), Grid([], 0, len(others))))
        self.reader = Reader(payload)
        count = self.reader.varint()
        if count > 256:
            raise Corrupt("number of attributes")
        self.attributes = []
        for _ in range(count):
            self.attributes.append(self._attribute())
        self.reader.end()

    def _attribute(self):
        name = self.reader.bytes(self.reader.varint()).decode("utf-8")
        number, components = self.reader.u8(), self.reader.varint()
        if number > 9 or not 1 <= components <= 65536 or not name:
            raise Corrupt("head of an attribute")
        if any(name == other[0] for other in self.attributes):
            raise Corrupt("two attributes of one name")
        form = self.reader.u8()
        if form == 0:
            bits = self._packed(TYPES[number], components)
        elif form == 1 and components <= 16:
            bits = self._columns(TYPES[number], components)
        else:
            raise Corrupt("form of an attribute")
        return name, number, components, bits

    def _packed(self, letter, components):
        form, data = self.reader.u8(), block(self.reader)
        size = struct.calcsize(letter)
        if form > 3 or len(data) != self.slots * components * size:
            raise Corrupt("packed values")
        if form & 2:
            data = join_planes(data, size)
        values = [int.from_bytes(data[i:i + size], "little") for i in range(0, len(data), size)]
        if form & 1:
            for i in range(components, len(values)):
                values[i] = (values[i] + values[i - components]) % (1 << 8 * size)
        return values

    def _columns(self, letter, components):
        bits = [0] * (self.slots * components)
        for part in self.parts:
            scale = self.reader.u8()
            if scale > BITS or (scale and letter not in "fd"):
                raise Corrupt("scale of an attribute")
            for component in range(components):
                keys = decode_column(self.reader, part)
                for slot, record in zip(part.slots, part.records):
                    bits[slot * components + component] = value_bits(keys[record], scale, letter)
        return bits


def value_bits(key, scale, letter):
    """The bits of the value with a key."""
    size = struct.calcsize(letter)
    if letter not in "fd":
        return key % (1 << 8 * size)
    if scale == BITS:
        sign = 1 << 8 * size - 1
        return sign | (-1 - key) % sign if key < 0 else key % sign
    value = struct.pack("<" + letter, clip(key, -1 << 53, 1 << 53) / DIVISORS[scale])
    return int.from_bytes(value, "little")


def decode_column(reader, part):
    form = reader.u8()
    if form < 4:
        decoder = RangeDecoder(reader.bytes(reader.varint()))
        keys = (in_slots if form < 2 else in_cells)(decoder, form, part)
        if decoder.exhausted:
            raise Corrupt("values end early")
        return keys
    if form == 4:
        least = unzigzag(reader.varint())
        return [wrapped(least + number) for number in decode_levels(reader, part.grid)]
    if form != 5:
        raise Corrupt("form of a column")
    count = reader.varint()
    if not 1 <= count <= 256:
        raise Corrupt("size of a palette")
    palette = [unzigzag(reader.varint())]
    while len(palette) < count:
        palette.append(wrapped(palette[-1] + reader.varint() + 1))
    numbers = decode_levels(reader, part.grid)
    if any(number >= count for number in numbers):
        raise Corrupt("a value that is not in its palette")
    return [palette[number] for number in numbers]


class Differences:
    def __init__(self, decoder):
        self.decoder = decoder
        self.models = [SignedNumbers() for _ in range(16)]
        self.last = self.before = 0

    def decode(self):
        number = self.models[4 * self.before + self.last].decode(self.decoder)
        self.before = self.last
        self.last = sum(abs(number) > bound for bound in (0, 3, 255))
        return number


def in_slots(decoder, form, part):
    differences, keys, last, before = Differences(decoder), [0] * part.grid.records, 0, 0
    for record in part.records:
        guess = 2 * last - before if form == 1 else last
        last, before = wrapped(guess + differences.decode()), last
        keys[record] = last
    return keys


def in_cells(decoder, form, part):
    grid, differences, keys = part.grid, Differences(decoder), []
    firings, of_row, step, last, last_row, last_column = {}, 0, 0, 0, 0, 0
    for row, column in grid.cells:
        guess = last
        if form == 3:
            firing = (column - grid.shift[row]) % grid.columns
            ahead = column - last_column
            if firing in firings:
                guess = firings[firing] + of_row
            else:
                guess = last + step * (ahead if row == last_row else 1)
        key = wrapped(guess + differences.decode())
        if form == 3:
            if firing in firings:
                of_row = wrapped(key - firings[firing])
            else:
                firings[firing] = wrapped(key - of_row)
            if row == last_row and ahead > 0:
                rise = wrapped(key - last)
                step = abs(rise) // ahead * (1 if rise >= 0 else -1)
            last_row, last_column = row, column
        last = key
        keys.append(key)
    for _ in range(grid.loose):
        last = wrapped(last + differences.decode())
        keys.append(last)
    return keys


def decode_levels(reader, grid):
    """A number for each record."""
    mantissa, bits = reader.u8(), reader.u8()
    decoder = RangeDecoder(reader.bytes(reader.varint()))
    if not 3 <= mantissa <= 7 or bits > 8:
        raise Corrupt("levels")
    dropped, numbers = [model() for _ in range(256)], []
    levels = Levels(decoder, bits, grid)
    for _ in range(grid.records):
        level = levels.decode()
        drop = max((level >> mantissa) - 1, 0)
        rest = 0
        if drop:
            rest = decide(decoder, dropped[level], 255) << drop - 1
            rest += plain_number(decoder, drop - 1)
        numbers.append((level - (drop << mantissa) << drop) + rest)
    if decoder.exhausted:
        raise Corrupt("values end early")
    return numbers
