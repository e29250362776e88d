"""Results for people and for programs: tables, figures, one self-contained page."""
