"""radhar: labelled FMCW radar data sets for human activity recognition.

The packages, in the order in which imports go (docs/reference/architecture.md):

    motion        movements of people and their skeleton, the paper's model, recordings, activities
    radar         waveform, propagation (delay, amplitude), wall (refraction, Fresnel), room
    processing    cancellers, range compression, compensation, STFT, FSST, entropy, image
    readers       files of others: movements, captures, points, .cfg
    echo          motion -> paths -> echo: exact (the reference), direct, gated, impulse, boards
    config        the schema of the YAML file, its checks, and how it is read
    scene         (config, class, index) -> one scene: drawn, built, computed, checked, written
    figures       panels, animations, pages, reports
    dataset       many scenes -> shards -> dataset.h5 and PNG; resume, verify, estimate
    capture       recordings of real radars -> maps, fitted configs, data sets
    learning      images -> trained networks and reports; the only package with PyTorch
    study         audit, comparison of two sets, what accuracy costs, how far numbers may go
    commands      one file per subcommand of the `radhar` program

Symbols (SI units, radians)::

    fc, B, Tp, K     start carrier (Hz), bandwidth (Hz), chirp length (s), K = B/Tp (Hz/s)
    fs, PRF, T       ADC rate (Hz), pulse repetition frequency (Hz), recording (s)
    n, N_ADC         fast-time sample, samples per chirp = round(fs Tp)
    m, M             pulse (slow time t_m = m/PRF), pulses = round(T PRF)
    k, N_FFT         range bin, range FFT length; bins 0 .. N_FFT/2 - 1 are kept
    n0, f0           phase reference in the chirp, frequency there f0 = fc + K n0/fs
    tau, A           two-way delay (s) and amplitude of a path (1, for unit transmit power)
    theta_i          angle of the link that *ends* at joint i, about y
    P                raised-cosine progress, 0 -> 1

Axes: x is range, y cross-range, z height. Positions are ``p[axis, joint, time]``; paths
``tau[path, pulse]``; a beat matrix ``s_b[n, m]`` (fast time first, as in the paper); every map
``[frequency or range, time]`` with the lowest frequency or range first. Only images are upside
down: row 0 is the top, the highest Doppler or the farthest range. Approaching is positive Doppler.

Source of the model: W. Gao, "RadHARSimulator V1: Model-Based FMCW Radar Human Activity
Recognition Simulator", 2025; docs/physics/model.md lists where and why we differ from it.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:  # for the completion of editors
    from radhar_cli.config import load_config as load_config
    from radhar_cli.config import load_radars as load_radars
    from radhar_cli.dataset.interface import generate as generate
    from radhar_cli.dataset.on_demand import sample as sample
    from radhar_cli.dataset.reading import open_dataset as open_dataset
    from radhar_cli.learning.interface import evaluate as evaluate
    from radhar_cli.learning.interface import train as train
    from radhar_cli.learning.samples import Samples as Samples
    from radhar_cli.learning.sequences import Sequences as Sequences
    from radhar_cli.learning.torch_dataset import torch_dataset as torch_dataset
    from radhar_cli.learning.trained_run import load_run as load_run
    from radhar_cli.scene.single.simulate import simulate as simulate
    from radhar_cli.study.audit.audit import audit as audit

__version__ = "0.1.0"

_INTERFACE = {
    "load_config": "radhar_cli.config",
    "load_radars": "radhar_cli.config",
    "simulate": "radhar_cli.scene.single.simulate",
    "generate": "radhar_cli.dataset.interface",
    "train": "radhar_cli.learning.interface",
    "evaluate": "radhar_cli.learning.interface",
    "audit": "radhar_cli.study.audit.audit",
    "open_dataset": "radhar_cli.dataset.reading",
    "sample": "radhar_cli.dataset.on_demand",
    "Samples": "radhar_cli.learning.samples",
    "Sequences": "radhar_cli.learning.sequences",
    "torch_dataset": "radhar_cli.learning.torch_dataset",
    "load_run": "radhar_cli.learning.trained_run",
}


def __getattr__(name: str) -> object:
    """Import the Python interface on first use, so that `import radhar_cli` stays light."""
    if name not in _INTERFACE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    try:
        return getattr(import_module(_INTERFACE[name]), name)
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing not in ("torch", "sklearn", "safetensors"):
            raise
        from radhar_cli.errors import how_to_install

        library = {"torch": "PyTorch", "sklearn": "scikit-learn"}.get(missing, missing)
        command = how_to_install("torch", "safetensors", "sklearn")
        raise ImportError(f"radhar.{name} needs {library}: {command}") from None


def __dir__() -> list[str]:
    return sorted(("__version__", *_INTERFACE))
