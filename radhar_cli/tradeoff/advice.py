"""What the numbers say, in words: which setting to choose for what."""

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

from radhar_cli.tradeoff.accuracy import Accuracy

# A level is a 255th of the displayed range: below this share, the images are the same for all uses.
SAME_IMAGE = 1e-3
# Beyond this share of the signal, physics that is left out is no refinement.
MATTERS_DB, SLIGHT_DB = -10.0, -40.0


def advice(records: Sequence[Mapping[str, Any]], accuracies: Sequence[Accuracy]) -> list[str]:
    """Sentences, each of which follows from the numbers beside it."""
    budgets = [one for one in records if one["group"] == "budget" and one["time_ratio"] is not None]
    said = [*_for_images(budgets), *_for_signals(budgets), *_others(records)]
    said += [_about_switch(one) for one in records if one["group"] == "switch"]
    return [*said, *_about_budgets(accuracies), *_about_physics(accuracies)]


def _for_images(budgets: Sequence[Mapping[str, Any]]) -> list[str]:
    enough = [one for one in budgets if (one["pixels_changed"] or 0) <= SAME_IMAGE]
    if not enough:
        return ["For images: no budget tried leaves them as the exact ones are."]
    loosest = enough[0]
    return [
        f"For images, {loosest['setting']} is enough: at most "
        f"{100 * loosest['pixels_changed']:.2g} % of the pixels differ from the exact image (SSIM "
        f"{loosest['ssim']:.6f}); it takes {loosest['time_ratio']:.2f} of the default's time."
    ]


def _for_signals(budgets: Sequence[Mapping[str, Any]]) -> list[str]:
    default = next((one for one in budgets if one["default"]), None)
    if default is None:
        return []
    tightest = budgets[-1]
    said = [
        f"The default, {default['setting']}: error {_db(default['signal_error_db'])} in the worst "
        f"scene, {default['sample_ms']:.1f} ms a sample.",
        f"For work on the slow-time signal itself, {tightest['setting']} costs "
        f"{tightest['time_ratio']:.2f} times the default ({tightest['echo_ratio']:.2f} times its "
        f"echo) and errs by {_db(tightest['signal_error_db'])}.",
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


def _others(records: Sequence[Mapping[str, Any]]) -> list[str]:
    said = []
    for one in records:
        if one["time_ratio"] is None:
            continue
        if one["group"] == "engine":
            said.append(
                f"The cube takes {one['time_ratio']:.1f} times as long as the default; it is for "
                "checking, raw echoes and motion within the chirp."
            )
        if one["group"] == "precision":
            said.append(
                f"Double precision at the default budget costs {one['time_ratio']:.2f} times as "
                "much and is chosen by itself where a budget asks for it: leave `precision: auto`."
            )
    return said


def _about_switch(one: Mapping[str, Any]) -> str:
    name, change = one["setting"], one["signal_error_median_db"]
    if one["time_ratio"] is None:
        return f"{name}: could not be computed for these scenes."
    cost = f"{one['time_ratio']:.1f} times the time of {one['time_over']}"
    if "FSST" in name:
        return (
            f"{name} instead of at the STFT's hop: {cost}; the images agree to SSIM "
            f"{one['ssim']:.3f} (worst scene)."
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
    if exact is None:
        return []
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
        if switch == name or without is None:
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
