"""The whole YAML file of a data set, checked across sections."""

from collections.abc import Iterable, Mapping
from typing import Any, Self, TypeAlias, TypeVar

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from radhar_cli.config.checks.data_set import (
    measured_problems,
    problems,
    problems_of_processing,
    problems_of_recordings,
)
from radhar_cli.config.first_level import MeasuredRequest, Request
from radhar_cli.config.several_radars import OTHERS_KEY
from radhar_cli.schema.section import Problem

R = TypeVar("R", bound=Request | MeasuredRequest)


def _require_none(request: R, mistakes: Iterable[Problem]) -> R:
    """Return a request that has no mistakes across sections; pydantic collects them otherwise."""
    if listed := list(mistakes):
        raise PydanticCustomError("across", "{problems}", {"problems": listed})
    return request


class Config(Request):
    """A data set: what to draw, what to compute, how to store it."""

    @model_validator(mode="after")
    def _consistent(self) -> "Config":
        return _require_none(self, self.problems())

    def problems(self) -> Iterable[Problem]:
        """Find the problems of this config, once defaults by model are filled in."""
        return problems(self.filled())

    def replace(self, values: Mapping[str, Any] | None = None, **more: Any) -> Self:
        """Return this config with other values, checked as if they stood in its file.

        Args:
            values: {dotted key: value}, such as {"radar.prf_hz": 128}; None for none.
            more: values of keys of the first level, such as snr_db=5.

        Raises:
            ConfigError: a value is out of place; names its key, and what would be right.
        """
        from radhar_cli import load_config

        document = self.model_dump(mode="json", exclude_unset=True)
        others = document.pop(OTHERS_KEY, None)
        overrides: dict[str, Any] = {**(values or {}), **more}
        changed = load_config(document, overrides, type(self))
        assert isinstance(changed, type(self))
        return changed.model_copy(update={OTHERS_KEY: getattr(self, OTHERS_KEY)} if others else {})


class ConfigOfRecordings(Config):
    """A config before its recordings are opened: sections are not checked against each other."""

    def problems(self) -> Iterable[Problem]:
        """Find the problems that do not depend on the recordings."""
        return problems_of_recordings(self.filled())


class ProcessedConfig(Config):
    """A config with radar and length of the recording that it processes, and checked for that."""

    def problems(self) -> Iterable[Problem]:
        """Find the problems of radar and processing together."""
        return problems_of_processing(self.filled())


class MeasuredConfig(MeasuredRequest):
    """A data set of recordings, which `radhar generate --recordings` makes of a `Config`."""

    @model_validator(mode="after")
    def _consistent(self) -> "MeasuredConfig":
        return _require_none(self, measured_problems(self))


AnyConfig: TypeAlias = Config | MeasuredConfig
