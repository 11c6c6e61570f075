"""Two runs of `simulate` leave the same bytes, in files of data and pictures alike."""

from pathlib import Path

import pytest
from helpers.command_line import process, radhar
from helpers.slow import slow_but

FMCW = "radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}\n"
SCENES = {
    "fmcw": FMCW + "snr_db: 20\nmaps: [rtm, fsst]",
    "sfcw": "radar: {waveform: sfcw, carrier_hz: 3e9, bandwidth_hz: 1e9, prf_hz: 200,"
    " steps: 128, dwell_s: 2e-5}\nsnr_db: 20",
    "cw": "radar: {waveform: cw, carrier_hz: 10e9, prf_hz: 500}",
    "impulse": "radar: {waveform: impulse, carrier_hz: 4e9, bandwidth_hz: 1e9, prf_hz: 200,"
    " profile_m: [1, 9], profile_samples: 600}\nmaps: [rtm]",
    "impulse iq": "radar: {waveform: impulse, output: iq, carrier_hz: 4e9, bandwidth_hz: 1e9,"
    " prf_hz: 200, profile_m: [1, 9], profile_samples: 80}\nmaps: [rtm, stft, fsst_compensated]",
    "board": "radar: {cfg: iwr1443boost, device: IWR1443BOOST}\nmotion: {range_m: 3}\n"
    "maps: [range_doppler, points]",
    "people": FMCW + "people: [{activity: punching}]\nroom: {box_m: {x: [-1, 12], y: [-4, 4]}}",
}


@pytest.mark.every(3)
@pytest.mark.parametrize("name", slow_but(SCENES, ("fmcw", "board", "people")))
def test_two_runs_leave_the_same_bytes(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = tmp_path / "scene.yaml"
    config.write_text(f"activities: [walking]\nduration_s: 0.3\nseed: 4\n{SCENES[name]}\n")
    raw = ["--raw"] if name in ("fmcw", "sfcw", "board") else []
    made = []
    for run in ("1", "2"):
        out = tmp_path / run
        command = ("simulate", config, "-o", out, "--html", *raw)
        if name == "fmcw":  # in two processes, whose sets have another order
            monkeypatch.setenv("PYTHONHASHSEED", run)
            done = process("-m", "radhar_cli", *command)
        else:
            done = radhar(*command)
        assert done.returncode == 0, done.stderr
        made.append({path.name: path.read_bytes() for path in out.iterdir()})
    first, second = made
    assert {"scene.h5", "scene.json", "scene.yaml", "view.html", "stickman.gif"} <= first.keys()
    assert first.keys() == second.keys()
    assert [file for file in first if first[file] != second[file]] == []
