"""Which effects a scene calls for, what each costs in time, and what each changes in the answer."""

from harness.studies.effects.study import EffectsStudy, effects_study

__all__ = ["EffectsStudy", "effects_study"]
