# SPDX-License-Identifier: BSD-3-Clause
"""Signed integers in contexts, as the chunks of points code them."""
from entropy import decide, decide_mixed

NODES = 64
RATE, LIMIT = 6, 255


def half_octave(n):
    if n < 4:
        return n
    top = n.bit_length() - 1
    return 2 * top + (n >> (top - 1) & 1)


def wrap64(n):
    return (n + (1 << 63)) % (1 << 64) - (1 << 63)


class IntegerDecoder:
    def __init__(self, inputs):
        self.tables = [{} for _ in range(inputs)]
        self.weights = {}
        self.signs = {}
        self.bits = {}

    def _node(self, decoder, contexts, node):
        models = [table.setdefault((context, node), [32768, 0])
                  for table, context in zip(self.tables, contexts)]
        count = len(models)
        weights = self.weights.setdefault(node, [65536 * 5 // (4 * count)] * count)
        return decide_mixed(decoder, models, weights, 0, RATE, LIMIT)

    def decode(self, decoder, contexts, sign):
        if self._node(decoder, contexts, 0):
            return 0
        negative = decide(decoder, self.signs.setdefault(sign, [32768, 0]), LIMIT)
        size = 0
        while size < 63 and self._node(decoder, contexts, 1 + size):
            size += 1
        r = 1 if size else 0
        for _ in range(size - 1):
            if r < 8:
                model = self.bits.setdefault(8 * size + r, [32768, 0])
                r = 2 * r + decide(decoder, model, LIMIT)
            else:
                r = 2 * r + decoder.plain()
        return -1 - r if negative else r + 1
