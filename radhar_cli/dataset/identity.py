"""Identity of a data set, on which its bytes depend: keys of the config, versions of libraries."""

import hashlib
import json
import operator
from typing import Any

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.identity import config_hash, flat_document, resolved
from radhar_cli.config.several_radars import NAME_KEY, key_among_radars
from radhar_cli.dataset.build_version import build_version
from radhar_cli.dataset.code_digest import code_digest
from radhar_cli.extensions import extensions, own_products
from radhar_cli.motion.activities.activity import own_activities
from radhar_cli.numerics.accelerators import installed

# What the user has added, and its digest, taken once: what it holds may change as it works.
_OWN: list[tuple[tuple[Any, ...], str]] = []


def own_digest() -> str | None:
    """Digest of the code of the products and activities that the user added; None without any."""
    parts = (*own_products(), *own_activities())
    if not parts:
        return None
    for digested, digest in _OWN:
        if len(parts) == len(digested) and all(map(operator.is_, parts, digested)):
            return digest
    products = [(product.name, product.needs, product.make) for product in own_products()]
    classes = [(activity.slug, activity.uses, activity.motion) for activity in own_activities()]
    _OWN[:] = [(parts, code_digest([*products, *classes], extensions()))]
    return _OWN[0][1]


def versions() -> dict[str, str]:
    """Versions of the libraries that decide the bytes of a data set, by name."""
    digest = own_digest()
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
        **({} if digest is None else {"own": digest}),
    }


def identity(config: AnyConfig) -> dict[str, Any]:
    """Identity of a data set as plain values: stored with it, and compared before it is resumed."""
    return {
        "keys": flat_document(resolved(config)),
        "versions": versions(),
        "hash": config_hash(config),
        "config": resolved(config),
    }


def identity_hash(named: dict[str, Any]) -> str:
    """SHA-256 of the keys and versions of an identity, in hex, which marks shards."""
    text = json.dumps([named["keys"], named["versions"]], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def differences(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """List the keys and versions in which two identities differ, a line each."""
    lines, radar = [], new.get("keys", {}).get(NAME_KEY)
    for part, prefix in (("keys", ""), ("versions", "versions.")):
        before, after = old.get(part, {}), new.get(part, {})
        lines += [
            f"{prefix}{key_among_radars(key, radar)}: "
            f"{json.dumps(before.get(key))} there, {json.dumps(after.get(key))} here"
            for key in sorted(before.keys() | after.keys())
            if before.get(key) != after.get(key)
        ]
    return lines
