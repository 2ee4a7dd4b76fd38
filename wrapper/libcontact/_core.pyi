from typing import Any

# What cffi makes from the public headers: its values have no types in Python.
ffi: Any
lib: Any
