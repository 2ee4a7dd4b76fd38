#include <libcontact/base.h>

const char *ct_status_name(ct_status status)
{
  switch (status) {
  case CT_OK:
    return "ok";
  case CT_NOT_CERTIFIED:
    return "not certified";
  case CT_ITERATION_LIMIT:
    return "iteration limit reached";
  case CT_NO_CONVERGENCE:
    return "no convergence";
  case CT_INVALID:
    return "invalid numbers";
  case CT_ERROR_ARGUMENT:
    return "impossible argument";
  case CT_ERROR_MEMORY:
    return "out of memory";
  case CT_ERROR_GEOMETRY:
    return "inverted or collapsed element";
  case CT_ERROR_STEP:
    return "time step above the stable one";
  case CT_ERROR_UNSUPPORTED:
    return "not supported";
  case CT_ERROR_FILE:
    return "file error";
  case CT_ERROR_BLOWUP:
    return "state is not finite";
  case CT_ERROR_ENERGY:
    return "energy from nothing";
  }
  return "unknown status";
}

const char *ct_version(void)
{
  static const char version[] = {'0' + CT_VERSION_MAJOR, '.', '0' + CT_VERSION_MINOR, '.',
                                 '0' + CT_VERSION_PATCH, 0};
  return version;
}

int ct_has_openmp(void)
{
#ifdef _OPENMP
  return 1;
#else
  return 0;
#endif
}
