"""Results as JSON."""

from __future__ import annotations

import json
from typing import Any


def json_text(content: Any) -> str:
    """Indented, with a last line break; NaN and infinities, which JSON does not have, raise ValueError."""
    return json.dumps(content, indent=2, allow_nan=False) + "\n"
