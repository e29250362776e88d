"""The contact laws in the words of `pair_style gran` and `fix wall/gran`.

n from j to i, overlap delta; every law of the scene is one plain function that returns `Words` (model, constants,
settings, judgement), and one row in the table of its family: `NORMAL`, `SLIDING`, `ROLLING`, `TORSION`.
"""

from harness.engines.liggghts.law.compose import (
    glued_types,
    header_lines,
    history,
    judgements,
    law_lines,
    model_words,
    observation_moves,
    particle_types,
    setting_words,
    told_history,
    too_many_bodies,
    type_count,
    wall_type,
)
from harness.engines.liggghts.law.couples import ROLLING, TORSION
from harness.engines.liggghts.law.normal import NORMAL
from harness.engines.liggghts.law.sliding import SLIDING

__all__ = [
    "NORMAL", "ROLLING", "SLIDING", "TORSION", "glued_types", "header_lines", "history", "judgements", "law_lines",
    "model_words", "observation_moves", "particle_types", "setting_words", "told_history", "too_many_bodies",
    "type_count", "wall_type",
]
