"""Runs for the viewer of rerun."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._run import Run, _needs

if TYPE_CHECKING:
    from ._arrays import Array

#: Colours from the smallest to the largest value: five of viridis.
_COLOURS = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))


def _colours(values: Array, low: float, high: float) -> Array:
    import numpy as np

    share = np.clip((values - low) / (high - low if high > low else 1.0), 0.0, 1.0)
    at = np.linspace(0.0, 1.0, len(_COLOURS))
    return np.stack([np.interp(share, at, [colour[k] for colour in _COLOURS]) for k in range(3)], axis=1).astype(np.uint8)


def write(run: Run, path: str | os.PathLike[str], field: str) -> Path:
    """All frames as points with a field as their colour, each body by itself, and the measures over time."""
    import numpy as np

    rerun: Any = _needs("rerun", "rerun-sdk")
    to, frames = Path(path), run.frames
    stream = rerun.RecordingStream("sphorge")
    stream.save(to)

    def scalars(of: Array) -> Array:
        return of if of.ndim == 1 else np.sqrt((of.astype(float) ** 2).sum(axis=1))

    ranges = [(float(values.min()), float(values.max())) for values in (scalars(frame[field]) for frame in frames) if values.size]
    low, high = min(of[0] for of in ranges), max(of[1] for of in ranges)
    for frame in frames:
        stream.set_time("time", duration=frame.time)
        positions, colours, bodies = frame.positions, _colours(scalars(frame[field]), low, high), frame["body"]
        for number, (name, spacing) in enumerate(zip(frame.bodies, frame.spacings)):
            own = bodies == number
            stream.log(f"bodies/{name}", rerun.Points3D(positions[own], colors=colours[own], radii=0.5 * spacing))
    history = run.history
    for name in run.measures:
        for time, value in zip(history["time"], history[name]):
            stream.set_time("time", duration=float(time))
            stream.log(f"measures/{name}", rerun.Scalars(float(value)))
    stream.flush()
    return to
