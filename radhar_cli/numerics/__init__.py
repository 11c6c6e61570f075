"""Numbers: array types, constants, rounding, random streams, optional compiled libraries."""
