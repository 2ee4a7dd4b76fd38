from setuptools import setup

setup(
    cffi_modules=["wrapper/build_core.py:ffi"], options={"bdist_wheel": {"py_limited_api": "cp310"}}
)
