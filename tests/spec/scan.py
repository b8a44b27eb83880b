# SPDX-License-Identifier: BSD-3-Clause
"""A compact file: from its bytes to ranges and coordinates."""
from container import Corrupt, Reader, read_chunks
from entropy import RangeDecoder, decide
from field import Field
from header import Parameters, RowTable
from integers import clip, sin_cos
from mask import MaskDecoder
from residual import ResidualDecoder
from rays import Rays
from surface import RayWindow, Window

PARAMETERS, SENSOR, INDEX, MASK, FIELD, RESIDUAL, RAYS = range(0x10, 0x17)
LAYERS = (MASK, FIELD, RESIDUAL)
TOP = 1 << 30


class Scan:
    """Decodes on construction. range, field: rows of Q16 ranges, 0 where there is none; surface:
    rows of numbers through all segments, -1 where there is none.

    cut: the file may end early. field_only: without the residual layer. region: (row, end row,
    column, end column); segments that do not touch it stay empty."""

    def __init__(self, data, cut=False, field_only=False, region=None):
        chunks = read_chunks(data, cut)
        self.complete = not cut or self._is_whole(data)
        self._header(chunks)
        p = self.parameters
        self.range, self.field, self.surface = (
            [[empty] * p.columns for _ in range(p.rows)] for empty in (0, 0, -1))
        self.planes = {}  # of the cells that have a range
        surfaces = 0
        layers = [self._layer(chunks, kind) for kind in LAYERS]
        if field_only:
            layers[2] = []
        for number, place in enumerate(p.segments()):
            if region and not _touches(place, region):
                continue
            parts = [layer[number] if number < len(layer) else None for layer in layers]
            surfaces += self._segment(place, parts, surfaces)

    @staticmethod
    def _is_whole(data):
        try:
            read_chunks(data)
        except Corrupt:
            return False
        return True

    def _header(self, chunks):
        def only(kind):
            found = [chunk for chunk in chunks if chunk.kind == kind and chunk.whole]
            if not found:
                raise Corrupt(f"no chunk 0x{kind:02x}")
            return found[0].payload
        self.parameters = p = Parameters(only(PARAMETERS))
        self.table = RowTable(only(SENSOR), p.rows)
        self.heights = self.table.height or [0] * p.rows
        self.offsets = self.table.range_offset or [0] * p.rows
        self.rays = None
        if self.table.has_rays:
            if p.turn_columns != p.columns or p.first_column:
                raise Corrupt("rays need the firings of a whole turn")
            self.rays = Rays(only(RAYS), p.rows, p.columns)
            self.table.elevation = self.rays.elevation
            self.offsets = [b - ray[3] for b, ray in zip(self.offsets, self.rays.rays)]
        elif any(chunk.kind == RAYS for chunk in chunks):
            raise Corrupt("rays of a scan that has none")

    def _count(self):
        return self.parameters.bands * self.parameters.sectors

    def _layer(self, chunks, kind):
        found = [chunk for chunk in chunks if chunk.kind == kind]
        wanted = self._count() if kind != RESIDUAL or self.parameters.residual_step else 0
        if len(found) > wanted or (self.complete and len(found) < wanted):
            raise Corrupt(f"{len(found)} chunks 0x{kind:02x} for {wanted} segments")
        return found

    def _segment(self, place, parts, first_surface):
        """Decodes one segment; gives the number of its surfaces."""
        row, column, rows, columns = place
        p = self.parameters
        mask_chunk, field_chunk, residual_chunk = parts
        if mask_chunk is None:
            return 0
        mask = self._mask(mask_chunk, place)
        _sound(mask_chunk, mask.complete_rows == rows, "mask")
        if mask.complete_rows < rows or field_chunk is None:
            return 0
        if self.rays:
            window = RayWindow(self.rays, row, column, rows, columns, p.step)
        else:
            window = Window(self.table.elevation[row:row + rows], p.turn_columns,
                            p.first_column + column, columns, p.step)
        field = self._field(field_chunk, window, mask, place)
        _sound(field_chunk, field.complete, "field")
        self.last_mask, self.last_field = mask, field  # for scans predicted from this one
        for (i, j), cell in field.known.items():
            range_ = clip(cell.range + self.offsets[row + i], 1, TOP)
            self.field[row + i][column + j] = self.range[row + i][column + j] = range_
            self.surface[row + i][column + j] = first_surface + cell.number
            self.planes[row + i, column + j] = window.in_cell(cell.surface, i, j).plane
        if residual_chunk is not None and field.complete:
            self._residual(residual_chunk, field, place)
        return field.surfaces

    def _mask(self, chunk, place):
        _, _, rows, columns = place
        return MaskDecoder(chunk.payload, rows, columns, self.parameters.turn_columns,
                           not chunk.whole)

    def _field(self, chunk, window, mask, place):
        p = self.parameters
        return Field(RangeDecoder(chunk.payload), window, mask.rows, p.root_log2, p.smallest_leaf,
                     not chunk.whole)

    def _residual(self, chunk, field, place):
        row, column, rows, _ = place
        p = self.parameters
        reader = Reader(chunk.payload)
        try:
            flag_bytes = reader.bytes(reader.varint())
        except Corrupt:
            if chunk.whole:
                raise
            return
        decoder = RangeDecoder(flag_bytes)
        flags = _leaf_flags(decoder, field)
        if decoder.exhausted:
            if not chunk.whole:
                return
            raise Corrupt("flags of residuals")
        coded = {}
        for (i, j), cell in field.known.items():
            if flags[cell.leaf]:
                base = self.field[row + i][column + j] if p.lattice else cell.range
                coded[i, j] = (cell.number, base)
        residual = ResidualDecoder(chunk.payload[reader.at:], rows, coded, p.residual_step,
                                   p.lattice, not chunk.whole)
        _sound(chunk, residual.complete_rows == rows, "residual")
        for (i, j), range_ in residual.range.items():
            if not p.lattice:
                range_ = clip(range_ + self.offsets[row + i], 1, TOP)
            self.range[row + i][column + j] = range_

    def point(self, row, column, across=0, up=0):
        """x, y, z in units of 2^-36 m, beside the middle of the cell by two binary angles."""
        p, r = self.parameters, self.range[row][column]
        if self.rays:
            return self.rays.point(row, column, r)
        sin_e, cos_e = sin_cos(self.table.elevation[row] + self.heights[row] * 683565276 // r + up)
        turn = p.first_column + column
        sin_a, cos_a = sin_cos((1 << 31) + (turn << 32) // p.turn_columns + across)

        def rounded(a, bits):
            return (a + (1 << bits - 1)) >> bits
        return (rounded(r * rounded(cos_e * cos_a, 30), 10),
                rounded(r * rounded(cos_e * sin_a, 30), 10), rounded(r * sin_e, 10))

    def points(self):
        """(x, y, z) in metres of the cells that have a range, row by row."""
        return [tuple(value / (1 << 36) for value in self.point(i, j))
                for i, row in enumerate(self.range) for j, r in enumerate(row) if r]


def _touches(place, region):
    row, column, rows, columns = place
    return (row < region[1] and region[0] < row + rows and column < region[3]
            and region[2] < column + columns)


def _sound(chunk, complete, what):
    if chunk.whole and not complete:
        raise Corrupt(f"the stream of a whole {what} chunk ends early")


def _leaf_flags(decoder, field):
    """Whether each leaf has residuals."""
    models = [[32768, 0] for _ in range(9)]
    flags = []

    def flag_at(row, column):
        cell = field.known.get((row, column))
        return flags[cell.leaf] if cell and cell.leaf < len(flags) else 2
    for block in field.leaves:
        left = flag_at(block.row + block.h // 2, block.column - 1)
        above = flag_at(block.row - 1, block.column + block.w // 2)
        flags.append(decide(decoder, models[3 * left + above], 255))
    return flags
