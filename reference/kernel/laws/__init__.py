"""Contact laws, one file each; `LAWS` in `registry.py` lists them."""
