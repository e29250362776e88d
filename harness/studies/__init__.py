"""The studies: what is asked of the engines and how the answers are judged."""
