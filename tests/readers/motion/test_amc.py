"""ASF/AMC: a pose known by hand, and the same skeleton written as BVH."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.amc import read_amc
from radhar_cli.readers.motion.bvh import read_bvh

ASF = """:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name upper
     direction 0 -1 0
     length 3
     axis 0 0 0 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 2
     name lower
     direction 0 -2 0
     length 2
     axis 0 90 0 XYZ
    dof rx
    limits (-10.0 170.0)
  end
:hierarchy
  begin
    root upper
    upper lower
  end
"""
HEAD = "#!OML:ASF x.asf\n:FULLY-SPECIFIED\n:DEGREES\n"


def ends(asf: str, amc: str) -> Float:
    """Ends [frames, bones, 3] of all bones."""
    file = read_amc(amc.encode(), "x.amc", asf.encode(), "x.asf")
    return file.positions(range(len(file.names)))


def test_a_pose_known_by_hand() -> None:
    """The root stands at (1, 2, 3) and turns 90 degrees about y; then each bone bends.

    An upper bone that points down and turns 90 degrees about x points to -z; the root's turn about
    y makes that -x. The lower bone bends about an axis of its own, x turned 90 degrees about y, -z.
    """
    amc = HEAD + "1\nroot 1 2 3 0 90 0\nupper 90 0 0\nlower 0\n2\nroot 0 0 0 0 0 0\n"
    amc += "upper 0 0 0\nlower 90\n3\nroot 0 0 0 0 0 0\nupper 90 0 90\nlower 0\n"
    right = [
        [[1, 2, 3], [-2, 2, 3], [-4, 2, 3]],
        [[0, 0, 0], [0, -3, 0], [-2, -3, 0]],
        # rx turns first: down goes to -z, which a turn about z leaves alone
        [[0, 0, 0], [0, 0, -3], [0, 0, -5]],
    ]
    np.testing.assert_allclose(ends(ASF, amc), right, atol=1e-12)
    last_first = ASF.replace("dof rx ry rz", "dof rz ry rx")
    # the numbers of `upper` are rz, ry, rx now, and rz turns first: down goes to x, and stays
    np.testing.assert_allclose(
        ends(last_first, amc)[2], [[0, 0, 0], [3, 0, 0], [5, 0, 0]], atol=1e-12
    )
    file = read_amc(amc.encode(), "x.amc", ASF.encode(), "x.asf")
    assert (file.rate, file.up, file.unit) == (120.0, "y", pytest.approx(0.0254 / 0.45))


def test_frames_may_begin_at_any_number_and_angles_be_radians() -> None:
    degrees = HEAD + "1\nroot 1 2 3 10 20 30\nupper 40 50 60\nlower 70\n"
    later = degrees.replace("\n1\n", "\n300\n")
    np.testing.assert_array_equal(ends(ASF, degrees), ends(ASF, later))
    assert read_amc(later.encode(), "x.amc", ASF.encode(), "x.asf").place(0) == "x.amc: frame 300"
    turned = [f"{np.radians(value):.15f}" for value in (10, 20, 30, 40, 50, 60, 70)]
    radians = HEAD.replace(":DEGREES", ":RADIANS")
    radians += "1\nroot 1 2 3 {} {} {}\nupper {} {} {}\nlower {}\n".format(*turned)
    np.testing.assert_allclose(ends(ASF, radians), ends(ASF, degrees), atol=1e-12)
    # angles of the skeleton have their own unit
    asf = ASF.replace("angle deg", "angle rad").replace("axis 0 90 0", f"axis 0 {np.pi / 2} 0")
    np.testing.assert_allclose(ends(asf, degrees), ends(ASF, degrees), atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_the_same_skeleton_as_bvh_has_its_joints_there(seed: int) -> None:
    """Axes, orders and degrees of freedom are drawn; turns go to BVH as angles in another order."""
    rng = np.random.default_rng(seed)
    count, frames = 8, 5
    parents = [None, *(int(rng.integers(0, n)) for n in range(1, count))]
    orders = ["".join(rng.permutation([*"xyz"])) for _ in range(count)]
    axes = [Rotation.identity()]
    reach = [np.zeros(3)]
    bones, local = "", []
    angles = rng.uniform(-80, 80, (count, frames, 3))
    for n in range(1, count):
        turned, own = rng.uniform(-90, 90, 3), "".join(rng.permutation([*"xyz"]))
        axes.append(Rotation.from_euler(own, turned, degrees=True))
        direction, length = rng.normal(size=3), rng.uniform(1, 5)
        reach.append(direction / np.linalg.norm(direction) * length)
        bones += (
            f"begin\n id {n}\n name b{n}\n direction {' '.join(map(repr, direction.tolist()))}\n"
            f" length {length!r}\n axis {' '.join(map(repr, turned.tolist()))} {own.upper()}\n"
            f" dof {' '.join('r' + letter for letter in orders[n])}\nend\n"
        )
    for n in range(count):  # lower case is scipy's word for turns about fixed axes, first to last
        turn = Rotation.from_euler(orders[n], angles[n], degrees=True)
        local.append(axes[n] * turn * axes[n].inv())
    children = [[m for m, parent in enumerate(parents) if parent == n] for n in range(count)]
    name = ["root", *(f"b{n}" for n in range(1, count))]
    links = "".join(
        f"{name[n]} {' '.join(name[m] for m in below)}\n"
        for n, below in enumerate(children)
        if below
    )
    root = " ".join(("TX TY TZ", *(f"R{letter.upper()}" for letter in orders[0])))
    asf = f":units\nlength 1\n:root\norder {root}\naxis XYZ\norientation 0 0 0\n"
    asf += f":bonedata\n{bones}:hierarchy\nbegin\n{links}end\n"
    moves = rng.normal(size=(frames, 3))
    amc = HEAD
    for frame in range(frames):
        amc += f"{frame + 1}\n"
        for n in range(count):
            values = [*(moves[frame].tolist() if n == 0 else []), *angles[n, frame].tolist()]
            amc += f"{name[n]} {' '.join(map(repr, values))}\n"
    order: list[int] = []

    def written(vector: Float) -> str:
        return " ".join(map(repr, vector.tolist()))

    def tree(n: int) -> str:
        order.append(n)
        parent = parents[n]
        offset = written(np.zeros(3) if parent is None else reach[parent])
        inner = "".join(tree(m) for m in children[n])
        inner = inner or f"End Site\n{{\nOFFSET {written(reach[n])}\n}}\n"
        channels = "3 " if n else "6 Xposition Yposition Zposition "
        return (
            f"{'JOINT' if n else 'ROOT'} {name[n]}\n{{\nOFFSET {offset}\n"
            f"CHANNELS {channels}Zrotation Xrotation Yrotation\n{inner}}}\n"
        )

    text = f"HIERARCHY\n{tree(0)}MOTION\nFrames: {frames}\nFrame Time: 0.01\n"
    euler = [local[n].as_euler("ZXY", degrees=True) for n in range(count)]
    for frame in range(frames):
        row = [*moves[frame], *(value for n in order for value in euler[n][frame])]
        text += " ".join(map(repr, map(float, row))) + "\n"
    bvh = read_bvh(text.encode(), "x.bvh")
    amc_file = read_amc(amc.encode(), "x.amc", asf.encode(), "x.asf")
    # a bone's end is where its children begin, or its end site
    begins = [name[children[n][0]] if children[n] else f"{name[n]}.end" for n in range(count)]
    there = bvh.positions([bvh.names.index(begin) for begin in begins])
    here = amc_file.positions([amc_file.names.index(one) for one in name])
    np.testing.assert_allclose(here, there, atol=1e-6)
