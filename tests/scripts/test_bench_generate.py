"""The benchmark's naive sample, which no build makes, is the sample that builds make."""

import bench_generate as bench
import numpy as np

from radhar_cli.config import load_config
from radhar_cli.scene.products.run import record


def test_the_naive_sample_shows_the_same() -> None:
    config = load_config(bench.PAPER, ["duration_s=0.2", "snr_db=140", "maps=[stft]"])
    scene = bench.scene(config, 7)
    ready = {"scene": scene, **record(scene, ["signal", "waveform"]).products}
    x = bench.naive_signal(scene)
    assert x.shape == ready["signal"].x[0, 0].shape
    signal = ready["signal"].with_samples(x[None, None])
    image = bench.Floor(config, "stft")
    naive, direct = (
        image.sample(ready | {"signal": one}).images["stft"].levels.astype(int)
        for one in (signal, ready["signal"])
    )
    assert np.abs(naive - direct).max() <= 1
    assert naive.any()


def test_a_further_map_can_be_measured(monkeypatch, capsys) -> None:
    """The sections that make whole samples run, on a scene that is soon made."""
    load = bench.load_config
    quick = ["duration_s=0.2", "image.size_px=32"]
    monkeypatch.setattr(bench, "load_config", lambda path, more=(): load(path, [*more, *quick]))
    monkeypatch.setattr(bench, "MAP_NAMES", ("stft", "rtm"))
    assert bench.maps(1)["rtm"]["own_ms"] > 0
    assert bench.rows(1)["ms"].keys() == {"naive", "cube", "direct", "synthesis", "floor"}
    assert "a further map" in capsys.readouterr().out
