"""What a data set's bytes depend on: the config's keys and the versions of the libraries."""

import hashlib
import json
from typing import Any

from radhar_cli.accelerators import installed
from radhar_cli.build_version import build_version
from radhar_cli.config.identity import config_hash, flat_document, resolved
from radhar_cli.config.schema import AnyConfig
from radhar_cli.registry import own_digest


def versions() -> dict[str, str]:
    """Versions of everything that decides bytes."""
    import h5py
    import isal
    import numpy as np
    import PIL
    import scipy

    return {
        "radhar": build_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "h5py": h5py.__version__,
        "pillow": PIL.__version__,
        "isal": isal.__version__,
        "numba": installed("numba") or "none",
        "pyfftw": installed("pyfftw") or "none",
        **({} if own_digest() is None else {"own": f"{own_digest()}"}),
    }


def identity(config: AnyConfig) -> dict[str, Any]:
    """Plain values to store with a data set and to compare before continuing it."""
    return {
        "keys": flat_document(resolved(config)),
        "versions": versions(),
        "hash": config_hash(config),
        "config": resolved(config),
    }


def identity_hash(named: dict[str, Any]) -> str:
    """SHA-256 of the keys and versions of an identity, in hex: what shards are marked with."""
    text = json.dumps([named["keys"], named["versions"]], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def differences(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """Lines naming the keys and versions in which two identities differ."""
    lines = []
    for part, prefix in (("keys", ""), ("versions", "versions.")):
        before, after = old.get(part, {}), new.get(part, {})
        lines += [
            f"{prefix}{key}: {json.dumps(before.get(key))} there, {json.dumps(after.get(key))} here"
            for key in sorted(before.keys() | after.keys())
            if before.get(key) != after.get(key)
        ]
    return lines
