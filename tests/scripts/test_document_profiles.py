"""The table of built-in radars in the documents: its rows are those of the profiles."""

import document_profiles

from radhar_cli.config.built_in_radars import read_radars


def test_each_profile_has_a_row_of_its_numbers_in_the_documents() -> None:
    """`python scripts/document_profiles.py COMMIT --seeds 3` writes them."""
    page = document_profiles.PAGE.read_text()
    nothing = dict.fromkeys(document_profiles.RANGES_M, (0.0, 1.0))
    for radar in read_radars():
        row = document_profiles.table_row(radar, nothing)
        assert row.rpartition("| 0; 1.00 | 0; 1.00 | 0; 1.00 |")[0] in page, radar.name


def test_points_of_a_walk_fall_with_range_and_lie_near_the_person() -> None:
    radar = next(radar for radar in read_radars() if radar.name == "iwr1642boost_clouds")
    points = document_profiles.measure_points(radar, [1])
    counts = [count for count, _ in points.values()]
    assert counts[0] > counts[1] > counts[2] > 0
    assert all(share > 0.9 for _, share in points.values())
