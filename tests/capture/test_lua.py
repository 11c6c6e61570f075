"""Scripts of mmWave Studio as people have them, and what header they give."""

import pytest

from radhar_cli.capture.ti_lua import read_lua
from radhar_cli.errors import CaptureError

PROFILE = "0, 77, 100, 6, 60, 0, 0, 0, 0, 0, 0, 29.982, 0, N, 10000, 0, 0, 30"
PLAIN = f"""
N = 128
ar1.ChanNAdcConfig(1, 0, 0, 1, 0, 0, 0, 2, 1, 0)
ar1.ProfileConfig({PROFILE})
ar1.ChirpConfig(0, 0, 0, 0, 0, 0, 0, 1, 0, 0)
ar1.FrameConfig(0, 0, 4, 100, 40, 0, 0, 1)
"""
LOOPS = """
local NUM_TX, N = 3, 0x100      -- hexadecimal
profile = {}
profile[0] = {0, 77, 7, 6, 65, 0, 0, 0, 0, 0, 0, 60.012, 0, N, 4400, 0, 0, 30}
ptx = {}
ptx[1] = {1, 0, 0}; ptx[2] = {0, 0, 1}; ptx[3] = {0, 1, 0}
info = debug.getinfo(1, 'S')
path = string.gsub(info.source, "@", "")
dofile(path .. "bitoperations.lua")
res, efuse = ar1.ReadRegister(0xFFFFE214, 0, 31)
chip = bit_rshift(bit_and(efuse, 0x03FC0000), 18)
if (chip == 0) then partId = 1243 elseif (chip == 0x70 or chip == 0x71) then partId = 1843
else WriteToLog("unknown " .. partId) end
--[[ chosen by hand:
partId = 1642 ]]
--HERE
if (partId == 1843) then
    if (ar1.ChanNAdcConfig(1, 1, 1, 1, 1, 1, 1, 2, 1, 0) == 0) then
        WriteToLog("success\\n", "green")
    else
        WriteToLog("failure\\n", "red")
    end
else
    ar1.ChanNAdcConfig(1, 1, 0, 1, 1, 1, 1, 2, 1, 0)
end
for n = 0, 0 do
    assert(ar1.ProfileConfig(profile[n][1], profile[n][2], profile[n][3], profile[n][4],
        profile[n][5], 0, 0, 0, 0, 0, 0, profile[n][12], profile[n][13], profile[n][14],
        profile[n][15], 0, 0, 30) == 0)
end
for i = 0, NUM_TX - 1 do
    ret = ar1.ChirpConfig(i, i, 0, 0, 0, 0, 0, unpack(ptx[i + 1]))
    if (ret ~= 0) then print("failure") return end
end
ar1.FrameConfig(0, NUM_TX-1, 0, 2^7, 1e2, 0, 1)
local socket = require"socket"
f = assert(io.open("timestamp.txt", 'w')); f:write(socket.gettime()); f:close()
"""
FUNCTIONS = """
local cfg = { freq = 77.0; slope = 29.982, rate = 10e3, n = 256, tx = {1, 0, 0}, }
function die(msg) error(msg) end
function check(name, ret) if ret ~= 0 then die(name .. " failed") end end
local function profile(id, samples)
  return id, cfg.freq, 100, 6, 60, 0,0,0, 0,0,0, cfg.slope, 0, samples or cfg.n, cfg.rate, 0, 0, 30
end
if cfg.n / cfg.rate * 1e3 >= 60 then die("longer than the ramp") end
check("channels", ar1.ChanNAdcConfig(1,0,0, 1,1,0,0, 2, 1, 0))
check("profile", ar1.ProfileConfig(profile(0)))
ar1.ChirpConfig(0, 0, 0, 0, 0, 0, 0, unpack(cfg.tx))
cfg.n = 64
ar1.FrameConfig(
   0, -- first
   0, --[[ last ]]
   4, math.floor(128.5), (3 + 5) * 10 / 2,
   0, 0, 1)
"""


def header_of(tmp_path, text):
    path = tmp_path / "capture.lua"
    path.write_text(text)
    return read_lua(path)[0]


def test_a_call_has_the_values_that_names_had_before_it(tmp_path):
    assert header_of(tmp_path, PLAIN + "N = 64\n").samples == 128
    assert header_of(tmp_path, PLAIN.replace("ar1.Profile", "N = N / 2\nar1.Profile")).samples == 64


def test_tables_loops_and_functions_are_followed(tmp_path):
    header = header_of(tmp_path, LOOPS.replace("--HERE", "partId = 1843"))
    assert (header.samples, header.loops, header.masks) == (256, 128, (1, 4, 2))
    assert header.receivers == (0, 1, 2, 3)
    header = header_of(tmp_path, FUNCTIONS)
    assert (header.samples, header.loops, header.receivers) == (256, 128, (0, 1))
    assert header.period_s == pytest.approx(0.04)


def test_what_the_chip_alone_knows_is_asked_for(tmp_path):
    with pytest.raises(CaptureError, match=r"lua:18: Ch.*depends on partId.*`partId = \.\.\.`"):
        header_of(tmp_path, LOOPS)
    alike = LOOPS.replace("ar1.ChanNAdcConfig(1, 1, 0,", "ar1.ChanNAdcConfig(1, 1, 1,")
    assert header_of(tmp_path, alike).samples == 256  # whichever chip it is


def test_the_settings_are_those_at_the_start_of_frames(tmp_path):
    later = PLAIN + "ar1.StartFrame()\nN = 64\n" + f"ar1.ProfileConfig({PROFILE})\n"
    assert header_of(tmp_path, later).samples == 128
    with pytest.raises(CaptureError, match="StartFrame: starts frames again, with other"):
        header_of(tmp_path, later + "ar1.StartFrame()\n")
    twice = PLAIN + "for i = 1, 3 do\nar1.StartFrame()\nRSTD.Sleep(1000)\nend\n"
    assert header_of(tmp_path, twice).samples == 128


def test_of_two_profiles_the_one_of_the_chirps_is_taken(tmp_path):
    other = f"ar1.ProfileConfig({PROFILE.replace('0, 77', '1, 78', 1)})\n"
    assert header_of(tmp_path, PLAIN + other).profile.start_ghz == 77
    second = PLAIN + other + "ar1.ChirpConfig(0, 0, 1, 0, 0, 0, 0, 1, 0, 0)\n"
    assert header_of(tmp_path, second).profile.start_ghz == 78


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("ar1.ProfileConfig(0, 77 100)", r"lua:1: 100: should be '\)', as in Lua"),
        ("N = 'abc", 'lua:1: "\'abc": is no Lua'),
        ("while true do N = 1 end", "does not end within"),
        ("N = " + "(" * 500 + "1" + ")" * 500, "nested"),
        ("function f() return f() end\nf()", "should call ar1.ChanNAdcConfig"),
        ("N = 'x'\nfor i = 1, 60 do N = N .. N end", "should call ar1.ChanNAdcConfig"),
        (PLAIN.replace("N,", "SAMPLES,"), "argument 14 depends on SAMPLES"),
        (PLAIN.replace("N,", "os.getenv('N'),"), r"argument 14 depends on os.getenv\(\.\.\.\)"),
        (PLAIN.replace("N,", "nil,"), "argument 14: should be a number"),
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
