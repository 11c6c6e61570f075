"""JSON of a walker as recorders, networks and depth cameras write it."""

import json
from collections.abc import Callable
from typing import Any

from helpers.poses import RATE, T, camera

from radhar_cli.numerics.arrays import Float

Writer = Callable[[Float, list[str]], Any]


def kinect(p: Float, names: list[str]) -> Any:
    """Frames of a Kinect's SDK by its own names: bodies that are not tracked, joints by name."""
    return [
        {
            "RelativeTime": f"00:00:{t:09.6f}",
            "Bodies": [
                {"IsTracked": False, "TrackingId": 0, "Joints": {}},
                {
                    "IsTracked": True,
                    "TrackingId": 72057,
                    "Joints": {
                        name: {
                            "JointType": number,
                            "TrackingState": 2,
                            "Position": {"X": -x, "Y": -y, "Z": z},
                        }
                        for number, (name, (x, y, z)) in enumerate(zip(names, body, strict=True))
                    },
                },
            ],
        }
        for t, body in zip(T.tolist(), camera(p).tolist(), strict=True)
    ]


def kinect_list(p: Float, names: list[str]) -> Any:
    """Joints as a list with their types as texts, times in ms."""
    return {
        "frames": [
            {
                "timestamp_ms": 1000 * t,
                "joints": [
                    {
                        "joint": name,
                        "position": {"x": x, "y": y, "z": z},
                        "trackingState": "Tracked",
                    }
                    for name, (x, y, z) in zip(names, body, strict=True)
                ],
            }
            for t, body in zip(T.tolist(), p.tolist(), strict=True)
        ]
    }


def kinectron(p: Float, names: list[str]) -> Any:
    """Joints with coordinates of the camera, the depth image and the colour image."""
    keys = ("cameraX", "cameraY", "cameraZ")
    frames = [
        {
            "joints": [
                {"name": n, **dict(zip(keys, xyz, strict=True)), "depthX": 0.4}
                for n, xyz in zip(names, body, strict=True)
            ]
        }
        for body in p.tolist()
    ]
    return {"fps": RATE, "frames": frames}


def azure(p: Float, names: list[str]) -> Any:
    """Azure Kinect's offline processor: mm, microseconds, a second body for some frames."""
    bodies = (1000 * camera(p)).tolist()
    return {
        "joint_names": names,
        "bone_list": [[names[0], names[1]]],
        "frames": [
            {
                "frame_id": n,
                "timestamp_usec": int(1e6 * T[n]) + 433,
                "num_bodies": 1 + (30 < n < 40),
                "bodies": [{"body_id": 9, "joint_positions": bodies[0]}] * (30 < n < 40)
                + [{"body_id": 1, "joint_positions": body, "joint_orientations": [[1, 0, 0, 0]]}],
            }
            for n, body in enumerate(bodies)
        ],
    }


def zed(p: Float, names: list[str]) -> Any:
    """ZED's exports: {nanoseconds: objects}, confidences of 0 to 100."""
    return {
        str(1_700_000_000_000_000_000 + int(1e9 * t)): {
            "is_new": True,
            "body_list": [
                {
                    "id": 0,
                    "tracking_state": "OK",
                    "keypoint": body,
                    "keypoint_2d": [[1.0, 2.0]] * len(names),
                    "keypoint_confidence": [88.0] * len(names),
                }
            ],
        }
        for t, body in zip(T.tolist(), p.tolist(), strict=True)
    }


def mmpose(p: Float, names: list[str]) -> Any:
    """MMPose's inferencer: instances of a frame, names by number."""
    return {
        "fps": RATE,
        "meta_info": {"keypoint_id2name": {str(n): name for n, name in enumerate(names)}},
        "instance_info": [
            {
                "frame_id": n,
                "instances": [{"keypoints": body, "keypoint_scores": [0.9] * len(names)}],
            }
            for n, body in enumerate(p.tolist())
        ],
    }


def by_number(p: Float, names: list[str]) -> Any:
    """{frame: {keypoints_3d: {joint: {x, y, z}}}} in mm."""
    return {
        str(n): {
            "time": t,
            "keypoints_3d": {
                name: dict(zip("xyz", xyz, strict=True))
                for name, xyz in zip(names, body, strict=True)
            },
        }
        for n, (t, body) in enumerate(zip(T.tolist(), (1000 * p).tolist(), strict=True))
    }


def by_joint(p: Float, names: list[str]) -> Any:
    """{joint: its positions}."""
    return {"fps": RATE, **{name: p[:, n].tolist() for n, name in enumerate(names)}}


def by_joint_and_axis(p: Float, names: list[str]) -> Any:
    """{joint: {x: its x of all frames, ...}}."""
    return {
        "fps": RATE,
        **{
            name: {axis: p[:, n, k].tolist() for k, axis in enumerate("xyz")}
            for n, name in enumerate(names)
        },
    }


def dates(p: Float, names: list[str]) -> Any:
    """Dates with times, joints by name."""
    return [
        {
            "timestamp": f"2026-05-01T12:00:{2 + t:09.6f}Z",
            "keypoints_3d": dict(zip(names, body, strict=True)),
        }
        for t, body in zip(T.tolist(), p.tolist(), strict=True)
    ]


def text_of(document: Any) -> bytes:
    return json.dumps(document).encode()


def lines_of(document: list[Any]) -> bytes:
    """A frame a line."""
    return b"\n".join(map(text_of, document))


# {what it is: (suffix, writer)}
JSON_FORMS: dict[str, tuple[str, Callable[[Float, list[str]], bytes]]] = {
    "Kinect": (".json", lambda p, names: text_of(kinect(p, names))),
    "Kinect, a list": (".json", lambda p, names: text_of(kinect_list(p, names))),
    "Kinectron": (".json", lambda p, names: text_of(kinectron(p, names))),
    "Azure Kinect": (".json", lambda p, names: text_of(azure(p, names))),
    "ZED": (".json", lambda p, names: text_of(zed(p, names))),
    "MMPose": (".json", lambda p, names: text_of(mmpose(p, names))),
    "by number": (".json", lambda p, names: text_of(by_number(p, names))),
    "by joint": (".json", lambda p, names: text_of(by_joint(p, names))),
    "by joint and axis": (".json", lambda p, names: text_of(by_joint_and_axis(p, names))),
    "a frame a line": (".jsonl", lambda p, names: lines_of(dates(p, names))),
}
