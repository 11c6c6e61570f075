"""What is in a recording, in numbers, for `radhar inspect`."""

from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.capture.findings import CLIPPED, LOST
from radhar_cli.capture.recording import Recording


def summarise_recording(path: Path) -> dict[str, Any]:
    """Summarise a recording.

    Raises:
        FolderError: it is none, or damaged.
    """
    with Recording(path) as one:
        info, flags = one.info, one.flags
        summary: dict[str, Any] = {
            "kind": "recording",
            "path": str(path),
            "bytes": path.stat().st_size,
            **info.model_dump(exclude={"receiver_delay_s"}),
            "duration_s": one.segments.duration,
            "complex": one.is_complex,
            "lost_pulses": int(np.count_nonzero(flags & LOST)),
            "clipped_pulses": int(np.count_nonzero(flags & CLIPPED)),
        }
        if info.samples is not None:
            waveform = info.waveform()
            summary["half_band_range_m"] = waveform.half_band_range
            summary["range_step_m"] = waveform.range_step
            summary["highest_speed_mps"] = waveform.highest_speed
        return summary
