"""The LCM types, generated from `lcm_types/*.lcm`: plan_t and the others.

LCM names the generated package after the types' own, `saddlewalk`, which this package has taken;
so the generated package is loaded here, in this module's place.
"""

import sys
from importlib.util import module_from_spec, spec_from_file_location
from typing import Any

from saddlewalk import paths

_init = paths.built("lcm/python/saddlewalk/__init__.py")
_spec = spec_from_file_location(__name__, _init, submodule_search_locations=[str(_init.parent)])
assert _spec and _spec.loader
_generated = module_from_spec(_spec)
sys.modules[__name__] = _generated
_spec.loader.exec_module(_generated)


def __getattr__(name: str) -> Any:
    """For type checkers: the generated package is in this module's place."""
    return getattr(_generated, name)
