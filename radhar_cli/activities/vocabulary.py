"""Words that people use for movements, and our names of the same meaning."""

from collections.abc import Iterable

from radhar_cli.errors import did_you_mean

SIMILAR = 0.74  # share of letters from which a name is taken for a mistyped one

# {word: our names of the same meaning, of which the first that is known counts}
MEANINGS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("picking_up", "pick_up", "picking", "bending", "bending_down"), ("grabbing",)),
    **dict.fromkeys(("picking_up_object", "reaching", "grasping", "grab"), ("grabbing",)),
    **dict.fromkeys(("boxing", "box", "punch", "hitting", "shadow_boxing"), ("punching",)),
    **dict.fromkeys(("kick", "front_kick"), ("kicking",)),
    **dict.fromkeys(("standing", "still", "idle", "static", "no_movement"), ("stationary",)),
    **dict.fromkeys(("sit", "sit_down", "sitting"), ("sitting_down",)),
    **dict.fromkeys(("stand_up", "rising", "getting_up_from_chair"), ("standing_up",)),
    **dict.fromkeys(("stand_up_from_floor", "get_up", "rising_from_floor"), ("getting_up",)),
    **dict.fromkeys(("turning", "rotating", "twisting", "body_rotation"), ("body_rotating",)),
    **dict.fromkeys(("turn_around", "turn"), ("turning_around",)),
    **dict.fromkeys(
        ("walk", "strolling", "pacing", "walking_towards", "walking_away"), ("walking",)
    ),
    **dict.fromkeys(("fall", "fall_down", "falling_down", "collapsing"), ("falling",)),
    **dict.fromkeys(("squat", "squats"), ("squatting",)),
    **dict.fromkeys(("jump", "jumps", "hopping"), ("jumping",)),
    **dict.fromkeys(("jumping_jack", "jack", "jacks", "star_jumps"), ("jumping_jacks",)),
    **dict.fromkeys(("lunge", "lunges"), ("right_lunge",)),
    **dict.fromkeys(("waving", "wave", "hand_waving", "raise_arm"), ("raising_right_arm",)),
    **dict.fromkeys(("stumble",), ("stumbling",)),
    **dict.fromkeys(("trip",), ("tripping",)),
}
# Movements that no model of ours makes, nor one that means the same.
UNKNOWN = frozenset(
    {
        *(
            "running",
            "run",
            "jogging",
            "jog",
            "sprinting",
            "sprint",
            "crawling",
            "crawl",
            "creeping",
        ),
        *("clapping", "clap", "lying", "lying_down", "lie_down", "sleeping", "dancing", "climbing"),
        *(
            "climbing_stairs",
            "stairs",
            "cycling",
            "drinking",
            "eating",
            "throwing",
            "pushing",
            "pulling",
        ),
        *(
            "limping",
            "gesture",
            "gestures",
            "swimming",
            "skipping",
            "push_ups",
            "sit_ups",
            "typing",
        ),
    }
)
FROM_FILES = "no model moves like this; motion files can (docs/guide/motion_files.md)"


def advice_on(name: str, known: Iterable[str], otherwise: str) -> str:
    """Advise on a name of a movement that is not known: what may be meant.

    Args:
        name: as somebody wrote it.
        known: our names that would do.
        otherwise: what is returned where nothing is meant.
    """
    names = list(known)
    meant = meaning_of(name, names)
    if meant is not None:
        return f"did you mean {meant!r}?"
    if _plain(name) in UNKNOWN:
        return FROM_FILES
    return did_you_mean(_plain(name), names, otherwise, SIMILAR)


def meaning_of(name: str, known: Iterable[str]) -> str | None:
    """Find the known name that means the same, or differs in case, spaces and hyphens alone."""
    word, names = _plain(name), set(known)
    return next(
        (candidate for candidate in (word, *MEANINGS.get(word, ())) if candidate in names), None
    )


def _plain(name: str) -> str:
    """Name in lower case with underscores for spaces and hyphens."""
    return name.strip().lower().replace(" ", "_").replace("-", "_")
