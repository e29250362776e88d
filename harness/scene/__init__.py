"""The scene as typed, frozen data: TOML in, one clear error out, effects and numbers resolved."""
