"""The programs that are compared compute the same; what is missing is said."""

import json

import bench_peers as bench
import pytest


@pytest.fixture(scope="module")
def table():
    return bench.compare(bench.Case.of("duration_s=0.1"), rounds=1, chirps=20, python=None)


def test_all_programs_compute_the_same(table):
    worst = {bench.MOVING: -90, bench.STOPPED: -200, bench.FAST: -80}
    differences = {
        (row["program"], row["model"]): row["difference_from_numpy_db"]
        for row in table
        if row["difference_from_numpy_db"] is not None
    }
    assert len(differences) == 3
    assert all(value < worst[model] for (_, model), value in differences.items()), differences


def test_what_is_extrapolated_is_said(table):
    assert [row["extrapolated"] for row in table] == [row["model"] == bench.MOVING for row in table]
    text = bench.markdown(table, "here")
    assert "(from 20 chirps)" in text
    assert all(known["machine"] in text for known in bench.PUBLISHED)
    assert json.loads(json.dumps(table))[0]["ms_a_chirp"] > 0


def test_a_python_without_mmwrt_is_told_from_one_with_it(tmp_path):
    assert bench.version_of_mmwrt(tmp_path / "none") is None
    assert "mmwrt" in bench.INSTALL
