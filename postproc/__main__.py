"""`python -m postproc STATE`: average one state."""

import sys

from postproc.average import main

sys.exit(main())
