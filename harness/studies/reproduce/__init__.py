"""The talks' results, reproduced: one declared study a result, put beside what the talk says."""
