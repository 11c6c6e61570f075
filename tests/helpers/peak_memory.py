"""Peak resident memory of a process, for the programs that memory tests run."""

# ru_maxrss would do on every POSIX system, but counts what the parent held when it forked, and a
# test worker holds gigabytes.
PEAK = """
from pathlib import Path
def peak():
    status = Path("/proc/self/status").read_text().splitlines()
    return 1024 * int(next(line for line in status if line.startswith("VmHWM")).split()[1])
"""
