/* Arrays between a page and the library, and texts of errors. */
#include "module.h"

#include <stdlib.h>

laboratory page;
ct_error page_error;

EXPORT(numbers) double *numbers(int32_t count)
{
  static double *array;
  static int32_t capacity;
  if (count > capacity) {
    free(array);
    array = malloc((size_t)count * sizeof *array);
    capacity = array == NULL ? 0 : count;
  }
  return array;
}

EXPORT(error_text) const char *error_text(void) { return page_error.text; }

EXPORT(version) const char *version(void) { return ct_version(); }
