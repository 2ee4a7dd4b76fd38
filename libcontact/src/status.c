#include <contact/status.h>

#include "error.h"

#include <stdarg.h>
#include <stdio.h>

const char *ct_status_name(ct_status status)
{
  switch (status) {
  case CT_OK: return "ok";
  case CT_NOT_CERTIFIED: return "not certified";
  case CT_ITERATION_LIMIT: return "iteration limit reached";
  case CT_NO_CONVERGENCE: return "no convergence";
  case CT_INVALID: return "invalid numbers";
  case CT_ERROR_ARGUMENT: return "impossible argument";
  case CT_ERROR_MEMORY: return "out of memory";
  case CT_ERROR_GEOMETRY: return "inverted or collapsed element";
  case CT_ERROR_STEP: return "time step above the stable one";
  case CT_ERROR_UNSUPPORTED: return "not supported";
  case CT_ERROR_FILE: return "file error";
  case CT_ERROR_BLOWUP: return "state is not finite";
  }
  return "unknown status";
}

const char *ct_version(void) { return "0.1.0"; }

ct_status ct_fail(ct_error *error, ct_status code, ct_place where, const char *format, ...)
{
  if (error != NULL) {
    error->code = code;
    error->body = where.body;
    error->element = where.element;
    error->point = where.point;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
  }
  return code;
}
