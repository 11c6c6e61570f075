"""The benchmark's naive sample, which no build makes, is the sample that builds make."""

import bench_generate as bench
import numpy as np

from radhar_cli.config import load_config
from radhar_cli.products.run import record


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
