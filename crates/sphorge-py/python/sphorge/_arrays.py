"""Bytes of numbers as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]


def array(packed: tuple[bytes | bytearray, str, int]) -> Array:
    """An array of (particles,) or (particles, components), over these bytes: those of ``bytes`` cannot be written to."""
    # Not before it is needed: the command line does without.
    import numpy as np

    data, kind, width = packed
    values = np.frombuffer(data, dtype=np.dtype(kind))
    return values if width == 1 else values.reshape(-1, width)
