"""`python -m hyperleg_design.cli`: the command line."""

import sys

from hyperleg_design.cli import main

sys.exit(main())
