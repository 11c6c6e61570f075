"""The paper's twelve classes, by which keys may differ."""

# {slug: movements that people make one after the other}, S1 to S12 in their order.
MOVEMENTS_OF_TWELVE = {
    "stationary": ("stationary",),
    "punching": ("punching",),
    "kicking": ("kicking",),
    "grabbing": ("grabbing",),
    "sitting_down": ("sitting_down",),
    "standing_up": ("standing_up",),
    "body_rotating": ("body_rotating",),
    "walking": ("walking",),
    "sitting_to_walking": ("standing_up", "walking"),
    "walking_to_sitting": ("walking", "sitting_down"),
    "falling_to_walking": ("getting_up", "walking"),
    "walking_to_falling": ("walking", "falling"),
}
# {slug or label in lower case: slug}
TWELVE = {
    name: slug
    for number, slug in enumerate(MOVEMENTS_OF_TWELVE, 1)
    for name in (slug, f"s{number}")
}
DEFAULT = "default"  # in `per_activity`: what holds for activities that it does not name
