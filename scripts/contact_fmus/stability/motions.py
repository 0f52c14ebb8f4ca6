"""What a scene of the atlas may be"""

from __future__ import annotations

from .edge import Edge
from .head_on import HeadOn
from .impact import Impact
from .rolling import Rolling, Tumbling
from .similar import Similar

Motion = Edge | HeadOn | Impact | Rolling | Similar | Tumbling
