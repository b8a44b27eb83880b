# SPDX-License-Identifier: BSD-3-Clause
"""Short names for what bytes, texts and files hold."""
import hashlib
from pathlib import Path


def digest(*parts):
    """16 hexadecimal digits for bytes, texts and the contents of files (Path)."""
    whole = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else \
            part.encode() if isinstance(part, str) else part
        whole.update(len(data).to_bytes(8, "little") + data)
    return whole.hexdigest()[:16]
