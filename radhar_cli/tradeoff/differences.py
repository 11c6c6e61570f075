"""The error of a setting in one scene: against exact data of the same scene, without noise."""

from typing import Any, NamedTuple

from radhar_cli.arrays import Complex, Float, Levels
from radhar_cli.pipeline.plan import plan
from radhar_cli.pipeline.run import run
from radhar_cli.tradeoff.measures import image_scores, map_error_db, relative_db
from radhar_cli.tradeoff.scenes import Scenes
from radhar_cli.tradeoff.settings import Setting

QUIET = "snr_db=null"


class Sample(NamedTuple):
    """One scene under one setting, noiseless.

    Attributes:
        signal: x [M - 1].
        power: the first map of the config.
        levels: its image.
        dynamic_range_db: of the image.
        measured_db: error of the signal that the direct engine measured itself, if it did.
    """

    signal: Complex
    power: Float
    levels: Levels
    dynamic_range_db: float
    measured_db: float | None


class SceneDifferences:
    """All settings in one scene; what several of them refer to is made once."""

    def __init__(self, scenes: Scenes, slug: str) -> None:
        self._scenes, self._slug = scenes, slug
        self._made: dict[tuple[str, ...], Sample] = {}

    def of(self, setting: Setting) -> dict[str, Any]:
        """How far the setting's data are from its reference, in numbers that JSON can hold."""
        found, right = self._sample(setting.shown), self._sample(setting.reference)
        row: dict[str, Any] = {"signal_error_db": relative_db(found.signal, right.signal)}
        if found.power.shape == right.power.shape:
            error, worst = map_error_db(found.power, right.power, right.dynamic_range_db)
            row |= {"map_error_db": error, "map_error_max_db": worst}
        if found.measured_db is not None:
            row["measured_error_db"] = found.measured_db
        return row | image_scores(found.levels, right.levels)

    def _sample(self, overrides: tuple[str, ...]) -> Sample:
        if overrides not in self._made:
            self._made[overrides] = self._make(overrides)
        return self._made[overrides]

    def _make(self, overrides: tuple[str, ...]) -> Sample:
        config = self._scenes.config((*overrides, QUIET))
        name = config.maps[0]
        asked = ["signal:plain", name, f"levels:{name}"]
        scene = self._scenes.draw(self._slug, config)
        recording = run(plan(config, asked), scene, config)
        products, accuracy = recording.products, recording.accuracy
        return Sample(
            products["signal:plain"],
            products[name],
            products[f"levels:{name}"],
            config.image.dynamic_range_db,
            accuracy.error_db if accuracy else None,
        )
