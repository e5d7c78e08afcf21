"""Cures as a part of the sentence that refuses a robot."""

from bench.dataset.robot_redundancy import use_connect
from bench.model.cures import Cure, CureCode


def cure_in_words(cure: Cure | None) -> str:
    """What follows the fault; nothing where there is no cure."""
    if cure is None:
        return ""
    if cure.code == CureCode.FIX_BASE:
        return (
            f"body {cure.names[0]!r} floats: no closure ties its free joint to the world, and it carries motors; "
            "to fix it to the world, remove its <freejoint/> from the MJCF, and its 7 numbers from the qpos of "
            "each keyframe"
        )
    if cure.code == CureCode.CONNECT:
        return f"; {use_connect(cure.names)}"
    values = ", ".join(f"{name} = {cure.positions[name]:.10g}" for name in cure.names)
    single = len(cure.names) == 1
    line = f"lock {'it' if single else 'them'}: [locked] {values} in robot.toml"
    if cure.code == CureCode.LOCK_SPRINGS:
        return f"; {'its spring is' if single else 'their springs are'} not in the model, {line}"
    if cure.others:
        return f"; a motor, a closure or a lock is missing, for example [locked] {values} in robot.toml"
    return f"; if {'it is' if single else 'they are'} held, {line}"
