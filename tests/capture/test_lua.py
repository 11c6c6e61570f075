"""Scripts of mmWave Studio as people have them, and what header they give."""

import time

import pytest

from radhar_cli.errors import CaptureError
from radhar_cli.readers.ti.ti_lua import read_lua

PROFILE = "0, 77, 100, 6, 60, 0, 0, 0, 0, 0, 0, 29.982, 0, N, 10000, 0, 0, 30"
PLAIN = f"""
N = 128
ar1.ChanNAdcConfig(1, 0, 0, 1, 0, 0, 0, 2, 1, 0)
ar1.ProfileConfig({PROFILE})
ar1.ChirpConfig(0, 0, 0, 0, 0, 0, 0, 1, 0, 0)
ar1.FrameConfig(0, 0, 4, 100, 40, 0, 0, 1)
"""
DEMO = f"""
local NUM_TX, N = 3, 0x100      -- hexadecimal
info = debug.getinfo(1, 'S')
path = string.gsub(info.source, "@", "")
dofile(path .. "bitoperations.lua")
res, efuse = ar1.ReadRegister(0xFFFFE214, 0, 31)
if (efuse == 0) then partId = 1243 elseif (efuse == 0x70) then partId = 1843
else WriteToLog("unknown " .. partId) end
--[[ chosen by hand:
N = 64 ]]
if (partId == 1843) then
    if (ar1.ChanNAdcConfig(1, 1, 1, 1, 1, 1, 1, 2, 1, 0) == 0) then
        WriteToLog("success\\n", "green")
    else
        WriteToLog("failure end\\n", "red")
    end
else
    ar1.ChanNAdcConfig(1, 1, 1, 1, 1, 1, 1, 2, 1, 0)
end
assert(ar1.ProfileConfig({PROFILE}) == 0)
for i = 0, NUM_TX - 1 do print(i) end
if (ar1.ChirpConfig(0, 0, 0, 0, 0, 0, 0, 1, 0, 0) == 0) then print("ok") else print("end") end
ar1.ChirpConfig(1, 1, 0, 0, 0, 0, 0, 0, 0, 1) ar1.ChirpConfig(2, NUM_TX-1, 0, 0, 0, 0, 0, 0, 1, 0)
ar1.FrameConfig(
   0, -- first
   NUM_TX-1, --[[ last ]]
   0, 2^7, (3 + 7) * 10, 0, 1)
local socket = require"socket"
f = assert(io.open("timestamp.txt", 'w')); f:write(socket.gettime()); f:close()
"""


NAMES = "".join(f"a{n}={n} " for n in range(9000)) + "do " + "ar1.FrameConfig(a1) " * 5000


def header_of(tmp_path, text):
    path = tmp_path / "capture.lua"
    path.write_text(text)
    return read_lua(path)[0]


def test_a_call_has_the_values_that_names_had_before_it(tmp_path):
    assert header_of(tmp_path, PLAIN + "N = 64\n").samples == 128
    assert header_of(tmp_path, PLAIN.replace("ar1.Profile", "N = N / 2\nar1.Profile")).samples == 64


def test_a_script_in_the_form_of_ti_demo_is_read(tmp_path):
    header = header_of(tmp_path, DEMO)
    assert (header.samples, header.loops, header.masks) == (256, 128, (1, 4, 2))
    assert header.receivers == (0, 1, 2, 3)
    assert header.period_s == pytest.approx(0.1)


def test_of_two_calls_that_differ_one_is_asked_for(tmp_path):
    other = DEMO.replace("    ar1.ChanNAdcConfig(1, 1, 1,", "    ar1.ChanNAdcConfig(1, 1, 0,")
    with pytest.raises(CaptureError, match=r"lua:18: ChanNAdcConfig: differs from line 12"):
        header_of(tmp_path, other)


def test_conditions_on_names_that_have_numbers_choose_a_branch(tmp_path):
    """As TI's own demo has them, of a chip that is written into a copy."""
    other = DEMO.replace("    ar1.ChanNAdcConfig(1, 1, 1,", "    ar1.ChanNAdcConfig(1, 1, 0,")
    lanes = """
if((partId == 1642) or (partId == 1843) or (partId == 6843)) then
    if (ar1.LVDSLaneConfig(0, 1, 1, 0, 0, 1, 0, 0) == 0) then print("end") else print(0) end
elseif ((partId == 1243) or (partId == 1443)) then
    if (ar1.LVDSLaneConfig(0, 1, 1, 1, 1, 1, 0, 0) == 0) then N = 64 end
end
if partId == 1843 then lanes = 2 else N = 64 end
assert("""
    other = other.replace("assert(", lanes, 1)
    path = tmp_path / "capture.lua"
    for part, lane_count, samples in ((1843, 2, 256), (1443, 4, 64)):
        path.write_text(other.replace("--[[ chosen", f"partId = {part}\n--[[ chosen"))
        header, stream = read_lua(path)
        assert (stream.lanes, header.samples) == (lane_count, samples)
    with pytest.raises(CaptureError, match="ChanNAdcConfig: differs from line"):
        header_of(tmp_path, other.replace("--[[ chosen", "partId = chip or 1843\n--[[ chosen"))


@pytest.mark.parametrize(
    "script",
    [
        PLAIN.replace("\nar1.C", "\nif fast then N = 64 end\nar1.C", 1),
        PLAIN.replace("\nar1.C", "\nfor N = 1, 2 do print(N) end\nar1.C", 1),
        PLAIN.replace("\nar1.P", "\nfunction set()\nar1.P").replace("\nar1.Chi", " end\nar1.Chi")
        + "N = 64\nset()\n",
        PLAIN.replace("N = 128", "N = 128 local N"),
        PLAIN.replace("N = 128", "N, M = unpack(sizes)"),
        PLAIN.replace("N = 128", "sizes.N = 128"),
        PLAIN.replace("N = 128", "sizes = {N = 128}"),
        PLAIN.replace("N = 128", "N = 128 or 64"),
    ],
)
def test_a_name_whose_value_depends_on_the_way_through_the_script_has_none(tmp_path, script):
    with pytest.raises(CaptureError, match="argument 14 depends on N, which is no number"):
        header_of(tmp_path, script)


@pytest.mark.every(3)
@pytest.mark.parametrize(
    "text",
    [
        "a," * 130_000,
        "ar1.FrameConfig((" * 16_000,
        "--[[" * 60_000,
        "{" * 260_000,
        "if a == 1 then " * 17_000,
        NAMES,
    ],
)
def test_a_long_script_takes_time_by_its_length(tmp_path, text):
    started = time.process_time()
    with pytest.raises(CaptureError):
        header_of(tmp_path, text)
    assert time.process_time() - started < 20


def test_the_settings_are_those_at_the_start_of_frames(tmp_path):
    later = PLAIN + "ar1.StartFrame()\nN = 64\n" + f"ar1.ProfileConfig({PROFILE})\n"
    assert header_of(tmp_path, later).samples == 128
    with pytest.raises(CaptureError, match="StartFrame: starts frames again, with other"):
        header_of(tmp_path, later + "ar1.StartFrame()\n")
    twice = PLAIN + "for i = 1, 3 do\nar1.StartFrame()\nRSTD.Sleep(1000)\nend\n"
    assert header_of(tmp_path, twice).samples == 128


def test_of_two_profiles_the_one_of_the_chirps_is_taken(tmp_path):
    other = f"ar1.ProfileConfig({PROFILE.replace('0, 77', '1, 78', 1)})\n"
    first = header_of(tmp_path, PLAIN + other).carrier_hz
    second = PLAIN.replace("ChirpConfig(0, 0, 0", "ChirpConfig(0, 0, 1") + other
    assert 77e9 <= first < 78e9
    assert header_of(tmp_path, second).carrier_hz == pytest.approx(first + 1e9)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("ar1.ProfileConfig(0, 77 100)", r"lua:1: ProfileConfig argument 2 depends on 77 100"),
        (PLAIN.replace("N,", "(" * 300 + "1" + ")" * 300 + ","), "argument 14 depends on"),
        (PLAIN.replace("ar1.ProfileConfig(", "pcall(ar1.ProfileConfig, "), "a name of this call"),
        (PLAIN.replace("ar1.ProfileConfig(", "ar1.ProfileConfig(("), "arguments without an end"),
        (PLAIN.replace("128", "9^9^9^9"), "argument 14 depends on N"),
        ("function f() return f() end\nf()", "should call ar1.ChanNAdcConfig"),
        ("N = 'x'\nfor i = 1, 60 do N = N .. N end", "should call ar1.ChanNAdcConfig"),
        (PLAIN.replace("N,", "SAMPLES,"), "argument 14 depends on SAMPLES"),
        (PLAIN.replace("N,", "os.getenv('N'),"), r"argument 14 depends on os.getenv\("),
        (PLAIN.replace("N,", "nil,"), r"14 depends on nil.* the number in its place"),
        (PLAIN.replace("N = 128", "N = 10 / 0"), "argument 14 depends on N,"),
        (PLAIN + "ar1.AdvanceFrameConfig(1, 0)", "subframes are not read from scripts"),
        (PLAIN.replace("ProfileConfig(", "ProfileConfig_mult(4, "), "device 1 alone is read"),
        (PLAIN.replace("0, 0, 4, 100, 40, 0, 0, 1", "0, 0"), "has 2 arguments"),
    ],
)
def test_other_scripts_are_refused_in_a_line(tmp_path, text, says):
    with pytest.raises(CaptureError, match=says) as error:
        header_of(tmp_path, text)
    assert "\n" not in str(error.value)
