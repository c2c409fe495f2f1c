import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def real_logs() -> Path:
    """Folder of real hardware logs, which is not part of the repository."""
    folder = Path(os.environ.get("HYPERLEG_DATA") or Path(__file__).resolve().parents[2].parent / "shared" / "data")
    if not folder.is_dir():
        pytest.skip(f"no real logs in {folder}; set HYPERLEG_DATA to their folder")
    return folder
