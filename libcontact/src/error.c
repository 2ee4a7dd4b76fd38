#include "error.h"

#include <stdarg.h>
#include <stdio.h>

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
