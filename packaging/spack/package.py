from spack.package import *


class Libcontact(CMakePackage):
    """Explicit finite-element contact-impact: closest points of curved faces, contact with friction and obstacles, and
    explicit time steps of solid bodies, in C99."""

    license("MIT")

    version("0.2.0")  # url and sha256 of the release's archive

    variant("openmp", default=True, description="threads within a step")
    variant("shared", default=True, description="a shared library")

    depends_on("c", type="build")
    depends_on("cmake@3.14:", type="build")

    def cmake_args(self):
        return [
            self.define_from_variant("LIBCONTACT_OPENMP", "openmp"),
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
        ]
