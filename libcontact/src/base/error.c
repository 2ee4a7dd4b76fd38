#include "error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Write the text from byte `start` on. A text that is too long is cut between characters and ends
 * with three dots. */
static void write_text(ct_error *error, size_t start, const char *format, va_list arguments)
{
  size_t capacity = sizeof error->text - start, end = sizeof error->text - sizeof "...";
  int length = vsnprintf(error->text + start, capacity, format, arguments);
  if (length < 0) error->text[start] = 0;
  if (length < 0 || (size_t)length < capacity) return;
  while (end > 0 && ((unsigned char)error->text[end] & 0xC0) == 0x80) end--;
  memcpy(error->text + end, "...", sizeof "...");
}

ct_status ct_fail(ct_error *error, ct_status code, ct_place where, const char *format, ...)
{
  if (error != NULL) {
    *error = (ct_error){
        .code = code, .body = where.body, .element = where.element, .point = where.point};
    va_list arguments;
    va_start(arguments, format);
    write_text(error, 0, format, arguments);
    va_end(arguments);
  }
  return code;
}

ct_status ct_check_options(int32_t cookie, const char *standard, ct_error *error)
{
  if (cookie == CT_DEF_COOKIE) return CT_OK;
  return CT_REFUSE(error, "the options do not start from %s", standard);
}

ct_status ct_blame(ct_error *error, ct_status status, ct_scene_part part, int32_t number)
{
  if (status != CT_OK && error != NULL) {
    error->part = part;
    error->number = number;
  }
  return status;
}

void ct_error_add(ct_error *error, const char *format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  write_text(error, strlen(error->text), format, arguments);
  va_end(arguments);
}
