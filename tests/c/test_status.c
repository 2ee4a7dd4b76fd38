/* Names of the codes, the version, and the contents of an error. */
#include "../../libcontact/src/base/error.h"
#include "bodies.h"

#include <ctype.h>

/* Texts of all lengths around the capacity: unchanged if they fit, else cut between characters and
 * ended by three dots. */
static void lengthy_text(void)
{
  ct_error error;
  enum { ROOM = sizeof error.text };
  char text[ROOM + 16], *dots;
  int whole = 1, marked = 1, placed = 1;
  for (int from = 0; from < 2; from++)
    for (size_t length = ROOM - 8; length < ROOM + 8; length++) {
      for (size_t i = 0; i < length; i++)
        text[i] = i % 2 == 0 ? (char)0xCE : (char)0xB5; /* epsilon, in two bytes */
      if (length % 2 == 1) text[length - 1] = 'x';
      text[length] = '\0';
      ct_fail(&error, CT_ERROR_FILE, CT_NOWHERE, "%.*s", from == 0 ? (int)length : 6, text);
      if (from == 1) ct_error_add(&error, "%s", text + 6);
      placed &= error.body == -1 && error.element == -1 && error.point == -1;
      dots = strstr(error.text, "...");
      if (length < ROOM) whole &= strcmp(error.text, text) == 0;
      else
        marked &= dots != NULL && dots[3] == '\0' && (dots - error.text) % 2 == 0 &&
                  memcmp(error.text, text, (size_t)(dots - error.text)) == 0;
    }
  tap_ok(placed, "no place is -1");
  tap_ok(whole, "a text that fits is complete, written at once or in two parts");
  tap_ok(marked, "a longer one is cut between two characters and ends with three dots");
}

int main(void)
{
  int distinct = 1, filled = 1;
  for (int i = 0; i <= CT_ERROR_ENERGY; i++) {
    const char *name = ct_status_name((ct_status)i);
    filled &= name != NULL && strlen(name) > 1;
    for (int j = 0; j < i; j++) distinct &= strcmp(name, ct_status_name((ct_status)j)) != 0;
  }
  tap_ok(filled && distinct, "thirteen codes have thirteen names");
  tap_ok(strcmp(ct_status_name(CT_OK), "ok") == 0, "success is ok");
  tap_ok(strcmp(ct_status_name((ct_status)99), "unknown status") == 0 &&
             strcmp(ct_status_name((ct_status)-1), "unknown status") == 0,
         "other numbers are unknown");

  const char *version = ct_version();
  int dots = 0, digits = 1;
  for (const char *c = version; *c != '\0'; c++) {
    dots += *c == '.';
    digits &= *c == '.' || isdigit((unsigned char)*c);
  }
  tap_ok(dots == 2 && digits && isdigit((unsigned char)version[0]),
         "the version %s reads major.minor.patch", version);

  ct_error error;
  memset(&error, 7, sizeof error);
  ct_status status = ct_fail(&error, CT_ERROR_STEP, (ct_place){1, 2, 3}, "%s %d", "number", 4);
  tap_ok(status == CT_ERROR_STEP && error.code == CT_ERROR_STEP && error.body == 1 &&
             error.element == 2 && error.point == 3 && strcmp(error.text, "number 4") == 0,
         "an error carries code, place and text");
  lengthy_text();
  tap_ok(ct_fail(NULL, CT_ERROR_MEMORY, CT_NOWHERE, "this text is not read") == CT_ERROR_MEMORY,
         "an error without a struct still has its code");

  ct_material steel = {2.1e5, 0.3, 7.8e-9, CT_LINEAR};
  memset(&error, 7, sizeof error);
  ct_error before = error;
  ct_status good = ct_material_check(&steel, &error);
  tap_ok(good == CT_OK && memcmp(&before, &error, sizeof error) == 0,
         "a call that succeeds does not change the error");
  return tap_done();
}
