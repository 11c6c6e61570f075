"""radhar: labelled FMCW radar data sets for human activity recognition.

The rooms, in the order in which data flows through them; imports never turn back:

    activity      the twelve activities: label, slug, class number, the parameters each one uses
    config        strict, frozen pydantic models of the YAML file, one per section
    randomness    named random streams
    scenario      (config, class, index) -> one scene: every number drawn
    body          skeleton, activities (angles over time), pose (angles -> positions)
    radar         waveform, propagation (delay, amplitude), wall (refraction, Fresnel), noise
    echo          paths -> echo: `cube` (exact reference), `direct` (closed form), range profiles
    processing    MTI, range compression, compensation, Savitzky-Golay, STFT, FSST, entropy, image
    pipeline      scene -> maps: which stages a request needs, and their only order
    dataset       many scenes -> shards -> dataset.h5 and PNG; resume, verify, estimate
    figures       colour maps, panels, confusion matrices, curves
    learning      images -> trained networks and reports; the only room with PyTorch
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
Recognition Simulator", 2025; docs/model.md lists where and why we differ from it.
"""

__version__ = "0.1.0"

_INTERFACE = {
    "load_config": "radhar_cli.config",
    "simulate": "radhar_cli.simulation.simulate",
    "open_dataset": "radhar_cli.dataset.reading",
}


def __getattr__(name: str) -> object:
    """Import the Python interface on first use, so that `import radhar_cli` stays light."""
    if name not in _INTERFACE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_INTERFACE[name]), name)
