"""What the choices of a training step cost, as ratios of one run.

    python scripts/bench_train.py [--px 128] [--batch 128] [--rounds 3]
    python scripts/bench_train.py --models NAME ... [--batch 32] [--json FILE]

Every variant runs in a process of its own, in turn, and the rounds are interleaved; printed are the
median step and its spread, the ratio to the step as `radhar train` does it, and the most memory a
process had. With --models the steps of those networks are timed instead: processor time of one
thread, which other work on the machine changes little.
"""

import argparse
import os
import statistics
import subprocess
import sys
from pathlib import Path

from reproduce_paper import as_text, commit, machine

VARIANTS = {
    "as radhar train does it": (),
    "memory returned after each array, as glibc does": ("returned",),
    "full complex FFT instead of rfft2": ("complex",),
    "the other precision": ("precision",),
}
STEPS = 4

STEP = """
import resource, sys, time, torch
from torch.nn.functional import cross_entropy
from radhar_cli.learning import machine
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.models.fftnet import GlobalFilter
from radhar_cli.learning.models.outputs import Outputs
from radhar_cli.processes.worker_process import keep_memory
name, px, batch, steps, *changes = sys.argv[1:]
px, batch, steps = int(px), int(batch), int(steps)
if "complex" in changes:
    def full(self, x):
        k = torch.view_as_complex(self.weight)
        return torch.fft.ifft2(torch.fft.fft2(x.to(self.weight.dtype)) * k).real
    GlobalFilter.forward = full
device = machine.choose_device("auto")
machine.use_deterministic_algorithms(device)
if "returned" not in changes:
    keep_memory()
precision = machine.choose_precision("auto", device)
if "precision" in changes:
    precision = torch.float32 if precision == torch.bfloat16 else torch.bfloat16
torch.manual_seed(0)
model = build_model(name, Outputs(12), (px, px)).to(device)
optimiser = torch.optim.Adam(model.parameters(), 1e-3)
x = torch.randn(batch, 3, px, px, device=device)
y = torch.randint(12, (batch,), device=device)
times = []
for _ in range(steps):
    start, processor = time.perf_counter(), time.process_time()
    with machine.autocast(device, precision):
        logits = model(x)
    cross_entropy(logits.float(), y).backward()
    optimiser.step()
    optimiser.zero_grad()
    if device.type == "cuda":
        torch.cuda.synchronize()
    clock = "processor" in changes
    times.append(time.process_time() - processor if clock else time.perf_counter() - start)
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
print(device.type, str(precision).removeprefix("torch."), peak, *times[1:])
"""


def timed(model: str, px: int, batch: int, *changes: str) -> tuple[str, float, list[float]]:
    """Steps of a process of its own.

    Returns:
        Device and precision; the most memory it had, GiB; seconds of each step but the first.
    """
    line = [sys.executable, "-c", STEP, model, px, batch, STEPS, *changes]
    done = subprocess.run(list(map(str, line)), stdout=subprocess.PIPE, text=True, check=True)
    device, precision, peak, *steps = done.stdout.split()
    return f"{device}, {precision}", float(peak), [float(step) for step in steps]


def models(names: list[str], px: int, batch: int, path: Path | None) -> None:
    """Print, and write, processor time of a step of each network."""
    os.environ["OMP_NUM_THREADS"] = "1"
    times = {}
    for name in names:
        kind, _, steps = timed(name, px, batch, "processor")
        times[name] = round(statistics.median(steps), 2)
        print(f"{name:<36} {kind:<14} {times[name]:7.2f} s a step", flush=True)
    if path:
        about = {"px": px, "batch": batch, "kind": kind, "commit": commit(), "machine": machine()}
        path.write_text(as_text({**about, "seconds": times}))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--px", type=int, default=128)
    parser.add_argument("--batch", type=int, default=128)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--models", nargs="+", default=[], help="networks to time instead")
    parser.add_argument("--json", type=Path, help="where the times of --models are written")
    options = parser.parse_args()
    if options.models:
        models(options.models, options.px, options.batch, options.json)
        return
    times: dict[str, list[float]] = {name: [] for name in VARIANTS}
    kinds, peaks = {}, {}
    for _ in range(options.rounds):
        for name, changes in VARIANTS.items():
            kinds[name], peaks[name], steps = timed("fftnet", options.px, options.batch, *changes)
            times[name] += steps
    own = statistics.median(next(iter(times.values())))
    print(f"fftnet, {options.px} x {options.px} px, batch {options.batch}; {options.rounds} rounds")
    for name, steps in times.items():
        middle = statistics.median(steps)
        print(
            f"{name:<48} {kinds[name]:<14} {middle:7.3f} s a step "
            f"({min(steps):.3f} to {max(steps):.3f})  ratio {middle / own:5.2f}  "
            f"{peaks[name]:.1f} GiB"
        )


if __name__ == "__main__":
    main()
