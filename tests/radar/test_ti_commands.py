"""Every command of a .cfg has the effect that it has on boards, or is said, or is refused."""

import re
from enum import Enum, auto
from pathlib import Path
from typing import NamedTuple

import pytest
from helpers.boards import CFG
from helpers.scatterers import ISK_CFG

from radhar_cli.errors import CaptureError
from radhar_cli.radar.ti_family import Family
from radhar_cli.readers.ti.ti_cfg import parse_ti_cfg
from radhar_cli.readers.ti.ti_commands import COMMANDS

SDK_3 = CFG.replace("cfarCfg 0 2 8 4 3 0 1130", "cfarCfg -1 0 2 8 4 3 0 15.0 1")
MCU_PLUS = SDK_3.replace("frameCfg 0 2 32 0 100 1 0", "frameCfg 0 2 32 0 80 100 1 0")
OLD_PEOPLE = (Path(__file__).with_name("cfg") / "iwr1642_pc.cfg").read_text()
LOW_POWER = """
channelCfg 7 3 0
chirpComnCfg 15 5 0 128 1 34 3
chirpTimingCfg 6 26 1 47.95 60
frameCfg 2 0 600 64 200 0
"""
BASES = {
    Family.SDK_1: CFG,
    Family.SDK_3: SDK_3,
    Family.MCU_PLUS: MCU_PLUS,
    Family.L_SDK: LOW_POWER,
    Family.PEOPLE: OLD_PEOPLE,
    Family.PEOPLE_3D: ISK_CFG,
    Family.OBSTACLES: CFG.replace(
        "cfarCfg 0 2 8 4 3 0 1130",
        "cfarCfg 1 4 12 4 2 8 2 350 30 2 0 5 50 0.5\ndbscanCfg 4 4 13 20 3 256",
    ),
}
TWELVE = "1 2 3 4 5 6 7 8 9 10 11 12"
CALIBRATION = " 1 0" * 12


class Effect(Enum):
    """What a line does to what a file says."""

    SIMULATED = auto()
    SAID = auto()
    SILENT = auto()
    UNKNOWN = auto()


class Row(NamedTuple):
    """A line that stands behind those of a family, and what becomes of it."""

    line: str
    effect: Effect | str  # or how it is refused
    families: tuple[Family, ...]


EVERY = tuple(BASES)
S1, S3, MCU, L, OLD, P3, OD = BASES
OF_FRAMES = (S1, S3, MCU, OLD, P3)
SIM, SAID, SILENT = Effect.SIMULATED, Effect.SAID, Effect.SILENT
ONE = "should be one transmitter a chirp"
ROWS = [
    Row("dfeDataOutputMode 1", SILENT, OF_FRAMES),
    Row("dfeDataOutputMode 2", "modeType = 2: should be 1 or 3", OF_FRAMES),
    Row("dfeDataOutputMode 4", "modeType = 4: should be 1 or 3", OF_FRAMES),
    Row("dfeDataOutputMode 5", "modeType = 5: should be 1 or 3", OF_FRAMES),
    Row("dfeDataOutputMode 3", "advFrameCfg is missing; a line that would do", OF_FRAMES),
    Row("channelCfg 7 7 0", SIM, (S1, S3, MCU)),
    Row("channelCfg 15 7", "has 2 numbers: should be 3, 4 or 5: channelCfg rxChannelEn", OF_FRAMES),
    Row("channelCfg 15 7 1", "cascading = 1: should be 0", OF_FRAMES),
    Row("channelCfg 15 7 0 1 2", SILENT, (MCU,)),
    Row("adcCfg 2 0", SIM, OF_FRAMES),
    Row("adcCfg 2 2", SIM, OF_FRAMES),
    Row("adcCfg 2 3", r"adcOutputFmt = 3: should be 0, 1 or 2 \(real, complex 1x and", OF_FRAMES),
    Row("adcCfg 2 1 0", "has 3 numbers: should be 2: adcCfg numADCBits adcOutputFmt", OF_FRAMES),
    Row("adcbufCfg -1 0 1 1 1", SILENT, EVERY),
    Row("adcbufCfg 0 1 1 1", SILENT, EVERY),
    Row("profileCfg 0 60 10 7 40 0 0 80 1 80 2499 0 0 30", SIM, (S1, S3, MCU)),
    Row("profileCfg 0 77 17 7 40 394758 0 100 1 80 2499 0 0 30", SIM, (S1, S3, MCU)),
    Row("profileCfg 0 77 17 7 40 0 0 100 9 80 2499 2 1 36", SILENT, (S1, S3, MCU)),
    Row("profileCfg 0 77 17 7 40 0 4 100 1 80 2499 0 0 30", SAID, (S1, S3, MCU)),
    Row(
        "profileCfg 0 77 17 7 40 0 0 -100 1 80 2499 0 0 30",
        "freqSlopeConst = -100: should be a number from",
        OF_FRAMES,
    ),
    Row("profileCfg 0 77 17 7 40 0 0 100 1 80 2499 0 0", "has 13 numbers: should be 14", OF_FRAMES),
    *(
        Row(f"chirpCfg 0 0 0 {numbers} 1", rf"{name} = 1: should be 0", OF_FRAMES)
        for name, numbers in (
            ("startFreqVar", "1 0 0 0"),
            ("freqSlopeVar", "0 1 0 0"),
            ("idleTimeVar", "0 0 1 0"),
            ("adcStartTimeVar", "0 0 0 1"),
        )
    ),
    Row("chirpCfg 0 0 0 0 0 0 0 3", f"txEnable = 3: {ONE}", (S1, S3, MCU, OLD)),
    Row("frameCfg 0 2 16 0 100 1 0", SIM, (S1, S3, P3)),
    Row("frameCfg 0 2 32 0 100 1", SILENT, (S1, S3)),
    Row("frameCfg 0 2 32 7 100 1 0", SIM, (S1, S3)),
    Row("frameCfg 0 2 32 0 100", "has 5 numbers: should be 6, 7 or 8: frameCfg", (S1, S3)),
    Row("frameCfg 0 2 16 0 80 100 1 0", SIM, (MCU,)),
    Row("frameCfg 0 2 32 0 96 100 1 0", "numAdcSamples = 96: should be 80", (MCU,)),
    Row("advFrameCfg 1 0 0 1 0", SILENT, (S1, S3, MCU, P3, OLD)),
    Row("advFrameCfg 1 1 0 1 0", "forceProfile = 1: should be 0", OF_FRAMES),
    Row("advFrameCfg 1 0 0", "has 3 numbers: should be 5: advFrameCfg numOfSub", OF_FRAMES),
    Row("subFrameCfg 0 0 0 1 64 50 0 2 1 50", "numOfBurst = 2: should be 1", OF_FRAMES),
    Row("subFrameCfg 0 0 0 1 64 50 0 1 2 50", "numOfBurstLoops = 2: should be 1", OF_FRAMES),
    Row("bpmCfg -1 0 0 2", SILENT, OF_FRAMES),
    Row("bpmCfg -1 1 0 2", "bpmCfg chirp0Idx chirp1Idx = 0 2: should be two chirps", (S1, S3, MCU)),
    Row("bpmCfg 1 0 2", "has 3 numbers: should be 4: bpmCfg subFrameIdx", OF_FRAMES),
    Row("bpmCfgAdvanced 1 2", f"bpmCfgAdvanced: is not simulated; {ONE}", EVERY),
    *(
        Row(f"{name} 0 1 2", f"{name}: is not read; should be profileCfg, chirpCfg", EVERY)
        for name in ("contModeCfg", "advChirpCfg", "LUTDataCfg")
    ),
    Row("ddmPhaseShiftAntOrder 0 1 2", "DDMA is not simulated; should be one trans", EVERY),
    *(
        row
        for name in ("procChain", "procChainCfg")
        for row in (
            Row(f"{name} 0", SILENT, EVERY),
            Row(f"{name} 1", rf"{name} procChain = 1: should be 0 \(TDM; DDMA is not", EVERY),
        )
    ),
    Row("subDataFrameCfg 0 80 96 1", SILENT, (MCU,)),
    Row("cfarCfg 0 2 4 2 2 0 1130", SIM, (S1,)),
    Row("cfarCfg -1 0 2 4 2 2 0 12.5 0", SIM, (S3, MCU)),
    Row("cfarCfg -1 0 2 8 4 3 0 15.0 1 0 0 1", SAID, (MCU,)),
    Row("cfarCfg 6 4 4 0 0 8 8 4 4 50 62 0", SIM, (OLD,)),
    Row("cfarCfg 2 8 4 3 0 12.0 0 0.5 0 1 1 1", SAID, (L,)),
    Row("cfarCfg 2 8 4 3 0 12.0 0", "has 7 numbers: should be 12: cfarCfg averageMode", (L,)),
    Row("cfarCfg 3 4 12 4 2 8 2 350 30 2 0 5 20", "detectMethod = 3: should be 1 or 2", (OD,)),
    Row("dbscanCfg 4 4 13 20 3 256", SILENT, (OD,)),
    Row("peakGrouping 1 1 1 1 60", SIM, (S1,)),
    Row("multiObjBeamForming -1 1 0.25", SIM, (S1, S3)),
    Row("clutterRemoval -1 0", SIM, (S1, S3)),
    Row(f"compRangeBiasAndRxChanPhase 0.1{CALIBRATION}", SIM, (S1, S3, MCU, P3)),
    Row("compRangeBiasAndRxChanPhase 0.1 1 0", "Re Im = 2 numbers: should be 12 pairs", (S1, S3)),
    Row("aoaFovCfg -1 -40 40 -20 20", SIM, (S1, S3, MCU)),
    Row("aoaFovCfg -40 40 -20 20", SIM, (L,)),
    Row("cfarFovCfg -1 0 0.3 4", SIM, (S1, S3, MCU)),
    Row("cfarFovCfg -1 1 -2 2", SIM, (S1, S3, MCU)),
    *(
        row
        for off, on in (
            ("extendedMaxVelocity -1 0", "extendedMaxVelocity -1 1"),
            ("nearFieldCfg -1 0 0 0", "nearFieldCfg -1 1 0 0"),
            ("calibDcRangeSig -1 0 -5 8 256", "calibDcRangeSig -1 1 -5 8 256"),
            (
                "measureRangeBiasAndRxChanPhase 0 1.5 0.2",
                "measureRangeBiasAndRxChanPhase 1 1.5 0.2",
            ),
        )
        for row in (Row(off, SILENT, EVERY), Row(on, SAID, EVERY))
    ),
    Row("nearFieldCfg 1", "has 1 numbers: should be 3 or 4: nearFieldCfg", EVERY),
    Row("dynamicRACfarCfg -1 4 4 2 2 8 12 4 8 5.00 8.00 0.40 1 1", SIM, (P3,)),
    Row("staticRACfarCfg -1 6 2 2 2 8 8 6 4 5.00 15.00 0.30 0 0", SILENT, (P3,)),  # its path is off
    Row("dynamicRangeAngleCfg -1 1.5 0.0300 1 0", SIM, (P3,)),
    Row("dynamicRangeAngleCfg -1 0.75 0.0010 0 0", "detectionMethod = 0: should be 1 or 2", (P3,)),
    Row("dynamicRangeAngleCfg -1 0.75 0.0010 1 1", "dopplerEstMethod = 1: should be 0", (P3,)),
    Row("dynamic2DAngleCfg -1 3.0 0.0300 1 0 1 0.30 0.85 8.00", SIM, (P3,)),
    Row("dynamic2DAngleCfg -1 5 1 0 0.95 8 1", "= 7 numbers: should be 9 with dynamic", (P3,)),
    Row("staticRangeAngleCfg -1 0 8 8", SILENT, (P3,)),
    Row("staticRangeAngleCfg -1 1 8 8", SIM, (P3,)),
    Row("dopplerCfarCfg -1 2 2 2 8 4", SILENT, (P3,)),
    Row("fineMotionCfg -1 0", SILENT, (P3,)),
    Row("fineMotionCfg -1 1 1.0 10 2", SIM, (P3,)),
    Row("fineMotionCfg -1 1", SAID, (P3,)),
    Row("fovCfg -1 60.0 20.0", SIM, (P3,)),
    Row(f"antGeometry0 {TWELVE}", SIM, (P3,)),
    Row(f"antGeometry1 {TWELVE}", SIM, (P3,)),
    Row("antPhaseRot 1 1 1 1 1 1 1 1 1 1 1 -1", SIM, (P3,)),
    Row("antPhaseRot 1 1 1 1 1 1 1 1 1 1 1 2", "antenna12 = 2: should be a number from", (P3,)),
    Row("sensorPosition 1.5 -10 15", SIM, (P3, S3, MCU)),
    Row("sensorPosition 0.5 0 1.5 -10 15", SIM, (L, P3)),
    Row("sensorPosition 0.5 0 1.5 -10 15 0", SIM, (L, P3)),
    Row("boundaryBox -2 2 0.5 6 0 3", SIM, (P3, S3)),
    Row("SceneryParam -3 3 0.5 6", SIM, (OLD,)),
    Row("doaCfg 500 1875 30 0", SIM, (OLD,)),
    Row("chirpComnCfg 15 5 0 128 4 34 3", SIM, (L,)),
    Row("chirpComnCfg 15 5 0 128 2 34 3", "chirpTxMimoPatSel = 2: should be 0, 1 or 4", (L,)),
    Row("chirpTimingCfg 6 20 1 47.95 60", SIM, (L,)),
    Row("frameCfg 2 0 600 32 200 0", SIM, (L,)),
    Row("channelCfg 3 3 0", SIM, (L,)),
    Row("factoryCalibCfg 1 0 40 6 0x1ff000", SIM, (L,)),
    Row("rangeSelCfg 0.5 4", SIM, (L,)),
    Row("sigProcChainCfg 32 2 1 0 4 4 0 15", SAID, (L,)),
    Row("cfarProcCfg 0 2 8 4 3 0 12 0", SAID, (L,)),
    Row("aoaProcCfg 64 64", SAID, (L,)),
    *(
        Row(f"{name} 1 2 3", SILENT, EVERY)
        for name in (
            *("staticBoundaryBox", "presenceBoundaryBox", "gatingParam", "stateParam"),
            *("allocationParam", "maxAcceleration", "trackingCfg", "classifierCfg", "GatingParam"),
            *("StateParam", "AllocationParam", "VariationParam", "AccelerationParam"),
            *("PointCloudEn", "vitalsign", "VSRangeIdxCfg", "VSTargetId", "mpdBoundaryBox"),
            *("clusterCfg", "majorStateCfg", "minorStateCfg", "microDopplerCfg"),
            *("profileSwitchCfg", "sensorStart", "sensorStop", "flushCfg", "lowPower"),
            *("guiMonitor", "dataLogger", "analogMonitor", "CQRxSatMonitor", "CQSigImgMonitor"),
            *("lvdsStreamCfg", "calibData", "configDataPort", "baudRate", "queryDemoStatus"),
            *("pmicCfg", "idlePowerCycle", "adcDataDitherCfg", "gpAdcMeasConfig"),
            *("apllFreqShiftEn", "runtimeCalibCfg", "adcDataSource", "adcLogging", "lowPowerCfg"),
            *("compressionCfg", "intfMitigCfg", "localMaxCfg", "rangeProcCfg"),
            *("antennaCalibParams", "enetStreamCfg", "spreadSpectrumConfig"),
            *("powerMeasCfg", "powerMeasurement"),
        )
    ),
    Row("quantumCfg 1", Effect.UNKNOWN, EVERY),
    Row("dynamic3DAngleCfg -1 1", Effect.UNKNOWN, EVERY),
]
CASES = [
    pytest.param(row, family, id=f"{row.line} ({family.value})")
    for row in ROWS
    for family in row.families
]


@pytest.mark.parametrize(("row", "family"), CASES)
def test_a_command_has_its_effect(row: Row, family: Family) -> None:
    text = BASES[family].rstrip("\n") + "\n"
    place = f"board.cfg:{text.count(chr(10)) + 1}: {row.line.split()[0]}"
    if isinstance(row.effect, str):
        with pytest.raises(CaptureError) as caught:
            parse_ti_cfg(f"{text}{row.line}\n", "board.cfg")
        message = str(caught.value)
        assert re.search(row.effect, message)
        assert message.startswith(place) or re.match(r"board\.cfg: \w+ is missing", message)
        assert "\n" not in message
        return
    before, after = (vars(parse_ti_cfg(words)).copy() for words in (text, f"{text}{row.line}\n"))
    said, unknown = after.pop("not_simulated"), after.pop("unknown")
    assert before.pop("unknown") == ()
    new = [name for name in said if name not in before["not_simulated"]]
    assert new == [row.line.split()[0]] * (row.effect is SAID)
    assert [*unknown] == [row.line.split()[0]] * (row.effect is Effect.UNKNOWN)
    del before["not_simulated"]
    if row.effect is not SAID:
        assert (after != before) is (row.effect is SIM)


def test_every_command_of_the_table_is_tested() -> None:
    tested = {re.sub("^powerMeas.*", "powerMeas*", row.line.split()[0]) for row in ROWS}
    of_the_array = {name for name in COMMANDS if name.startswith("antGeometry")}
    assert set(COMMANDS) - tested <= of_the_array
