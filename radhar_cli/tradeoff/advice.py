"""What the numbers say, in words: which setting to choose for what."""

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

from radhar_cli.tradeoff.accuracy import BAND, Accuracy

# A level is a 255th of the displayed range: below this share, the images are the same for all uses.
SAME_IMAGE = 1e-3
# Beyond this share of the signal, physics that is left out is no refinement.
MATTERS_DB, SLIGHT_DB = -10.0, -40.0
# Of a time, as a share.
QUIET = 0.1
# Fewer training seeds are a smoke run.
MIN_SEEDS = 3


def advice(records: Sequence[Mapping[str, Any]], accuracies: Sequence[Accuracy]) -> list[str]:
    """Sentences, each of which follows from the numbers beside it."""
    timed = [one for one in records if one["time_ratio"] is not None]
    budgets = [one for one in timed if one["group"] == "budget"]
    default = next((one for one in budgets if one["default"]), None)
    noise = _noise(default)
    said = [*_about_noise(noise), *_for_images(budgets, noise)]
    if default is not None:
        said += _for_signals(budgets, default, noise)
    said += _others(timed, noise)
    said += [_about_switch(one) for one in timed if one["group"] == "switch"]
    return [*said, *_about_budgets(accuracies), *_about_physics(accuracies)]


def _noise(default: Mapping[str, Any] | None) -> float:
    """How far from 1 the default reads when it is timed against itself."""
    if default is None:
        return 0.0
    names = ("time_ratio", "time_ratio_low", "time_ratio_high")
    return max(abs(float(default[name]) - 1) for name in names)


def _about_noise(noise: float) -> list[str]:
    if noise <= QUIET:
        return []
    return [
        f"The machine was busy, or the look was quick: the default timed against itself is off by "
        f"{100 * noise:.0f} %. Smaller differences in time mean nothing."
    ]


def _cost(one: Mapping[str, Any], noise: float) -> str:
    """What a setting costs over the default's time, as far as that could be measured."""
    if abs(one["time_ratio"] - 1) <= noise:
        return "the default's time, as far as could be measured"
    return f"{one['time_ratio']:.2f} of the default's time"


def _for_images(budgets: Sequence[Mapping[str, Any]], noise: float) -> list[str]:
    if all(not one["pixels_changed"] for one in budgets):
        return ["For images, any budget will do: all of them are exactly the cube's."]
    enough = [one for one in budgets if (one["pixels_changed"] or 0) <= SAME_IMAGE]
    if not enough:
        return ["For images: no budget tried leaves them as the exact ones are."]
    loosest = enough[0]
    return [
        f"For images, {loosest['setting']} is enough: at most "
        f"{100 * loosest['pixels_changed']:.2g} % of the pixels differ from the exact image (SSIM "
        f"{loosest['ssim']:.6f}); it takes {_cost(loosest, noise)}."
    ]


def _for_signals(
    budgets: Sequence[Mapping[str, Any]], default: Mapping[str, Any], noise: float
) -> list[str]:
    if default["signal_error_db"] is None:
        return ["Nothing moves in these scenes: after MTI no budget can err."]
    tightest = budgets[-1]
    said = [
        f"The default, {default['setting']}: error {_db(default['signal_error_db'])} in the worst "
        f"scene, {default['sample_ms']:.1f} ms a sample.",
        f"For work on the slow-time signal itself, {tightest['setting']} errs by "
        f"{_db(tightest['signal_error_db'])} and takes {_cost(tightest, noise)} "
        f"({tightest['echo_ratio']:.2f} of its echo's).",
    ]
    named = {one["setting"]: one for one in budgets}
    four = [f"{db} dB" for db in (-40, -60, -80, -100)]
    if all(name in named for name in four):
        ratios = ", ".join(f"{named[name]['time_ratio']:.2f}" for name in four)
        echoes = ", ".join(f"{named[name]['echo_ratio']:.2f}" for name in four)
        said.append(
            f"Cost of -40, -60, -80, -100 dB over the default: {ratios} a sample ({echoes} its "
            "echo)."
        )
    return said


def _others(timed: Sequence[Mapping[str, Any]], noise: float) -> list[str]:
    said = []
    for one in timed:
        if one["group"] == "engine":
            said.append(
                f"The cube takes {one['time_ratio']:.1f} times as long as the default; it is for "
                "checking, raw echoes and motion within the chirp."
            )
        if one["group"] == "precision":
            said.append(
                f"Double precision at the default budget takes {_cost(one, noise)}; it is chosen "
                "by itself where a budget asks for it: leave `precision: auto`."
            )
    return said


def _about_switch(one: Mapping[str, Any]) -> str:
    name, change = one["setting"], one["signal_error_median_db"]
    cost = f"{one['time_ratio']:.1f} times the time of {one['time_over']}"
    if "FSST" in name:
        return (
            f"{name} instead of at the STFT's hop: {cost}; the images agree to SSIM "
            f"{one['ssim']:.3f} (worst scene): for ridges as fine as MATLAB draws them, not for "
            "data sets."
        )
    if change is None:
        return f"{name}: nothing moves here."
    if change > MATTERS_DB:
        verdict = "switch it on where data shall resemble such a radar or wall"
    elif change > SLIGHT_DB:
        verdict = "worth it for work on phases, seldom for images"
    else:
        verdict = "leave it off"
    return (
        f"{name}: without it the signal differs by {_db(change)} (median), the image by SSIM "
        f"{one['ssim']:.3f} at worst; {cost}: {verdict}."
    )


def _about_budgets(accuracies: Sequence[Accuracy]) -> list[str]:
    """Whether a network notices the engine's error."""
    engines = [a for a in accuracies if a.name.endswith(" dB") or a.name == "cube"]
    exact = next((a for a in engines if a.name == "cube"), None)
    if exact is None or len(exact.seeds) < MIN_SEEDS:
        return []
    low, high = BAND
    if not low <= exact.mean <= high:
        return [
            f"No SNR was found at which the exact cube is right in {100 * low:.0f} to "
            f"{100 * high:.0f} % of cases (it is in {_percent(exact)}): differences between "
            "budgets may not show."
        ]
    behind = [a for a in engines if a.high < exact.low]
    if behind:
        names = ", ".join(f"{a.name} ({_percent(a)})" for a in behind)
        return [f"A network notices the engine's error: {names} against {_percent(exact)} (cube)."]
    return [
        f"A network notices no budget: {min(_percent(a) for a in engines)} to "
        f"{max(_percent(a) for a in engines)} right, trained on the exact cube {_percent(exact)}."
    ]


def _about_physics(accuracies: Sequence[Accuracy]) -> list[str]:
    """Whether training without some physics costs anything on data that have it."""
    named = {a.name: a for a in accuracies}
    said = []
    for name, proper in named.items():
        switch = name.removeprefix("with ")
        without = named.get(f"without {switch}, tested with it")
        if switch == name or without is None or len(proper.seeds) < MIN_SEEDS:
            continue
        costs = "costs" if without.high < proper.low else "shows no sure loss:"
        said.append(
            f"Training without {switch} {costs} {_percent(without)} right on data with it, against "
            f"{_percent(proper)} when trained with it."
        )
    return said


def _percent(accuracy: Accuracy) -> str:
    return f"{100 * accuracy.mean:.1f} %"


def _db(value: float | None) -> str:
    if value is None:
        return "nothing (no signal)"
    return "nothing" if value == -inf else f"{value:.0f} dB"
