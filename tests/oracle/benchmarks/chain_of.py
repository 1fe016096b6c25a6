"""The serial chain to a tip link, as `pinocchio_kinematics.cpp` reads it: `chain_of.py FILE TIP`."""

import sys

import pinocchio


def lines(path, tip):
    model = pinocchio.buildModelFromUrdf(path)
    frame = model.frames[model.getFrameId(tip)]
    for joint in list(model.supports[frame.parentJoint])[1:]:
        yield line(model.joints[joint].shortname()[-1], model.jointPlacements[joint])
    yield line("T", frame.placement)


def line(kind, placement):
    rows = placement.homogeneous[:3]
    return " ".join([kind, *(repr(float(number)) for row in rows for number in row)])


if __name__ == "__main__":
    print("\n".join(lines(*sys.argv[1:])))
