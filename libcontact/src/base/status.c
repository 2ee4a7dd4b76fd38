#include <libcontact/base.h>

const char *ct_status_name(ct_status status)
{
  static const char *const names[] = {[CT_OK] = "ok",
                                      [CT_NOT_CERTIFIED] = "not certified",
                                      [CT_ITERATION_LIMIT] = "iteration limit reached",
                                      [CT_NO_CONVERGENCE] = "no convergence",
                                      [CT_INVALID] = "invalid numbers",
                                      [CT_ERROR_ARGUMENT] = "impossible argument",
                                      [CT_ERROR_MEMORY] = "out of memory",
                                      [CT_ERROR_GEOMETRY] = "inverted or collapsed element",
                                      [CT_ERROR_STEP] = "time step above the stable one",
                                      [CT_ERROR_UNSUPPORTED] = "not supported",
                                      [CT_ERROR_FILE] = "file error",
                                      [CT_ERROR_BLOWUP] = "state is not finite",
                                      [CT_ERROR_ENERGY] = "energy from nothing"};
  return (size_t)status < sizeof names / sizeof names[0] ? names[status] : "unknown status";
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
