/* Test Anything Protocol in one header: each check prints a line, tap_done() prints the plan. */
#ifndef TAP_H
#define TAP_H

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static int tap_count, tap_failed;

static void tap_line(int ok, const char *suffix, const char *format, va_list arguments)
{
  tap_count++;
  if (!ok) tap_failed++;
  printf("%s %d - ", ok ? "ok" : "not ok", tap_count);
  vprintf(format, arguments);
  printf("%s\n", suffix);
  fflush(stdout);
}

/* Passes when `ok` is not zero. */
static inline int tap_ok(int ok, const char *format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  tap_line(ok, "", format, arguments);
  va_end(arguments);
  return ok;
}

/* Passes when |got - want| <= tol; a NaN fails. */
static inline int tap_close(double got, double want, double tol, const char *format, ...)
{
  char detail[160];
  int ok = fabs(got - want) <= tol;
  snprintf(detail, sizeof detail, " (got %.17g, want %.17g, off %.3g, allowed %.3g)", got, want,
           fabs(got - want), tol);
  va_list arguments;
  va_start(arguments, format);
  tap_line(ok, detail, format, arguments);
  va_end(arguments);
  return ok;
}

/* Counts as passed, and gives the reason why it was not run. */
static inline void tap_skip(const char *format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  tap_line(1, " # SKIP", format, arguments);
  va_end(arguments);
}

/* How often to repeat a check of random numbers: `count` times, and TAP_LONG times as often if the
 * environment has TAP_LONG, as in `make fuzz`. */
static inline int tap_times(int count)
{
  const char *more = getenv("TAP_LONG");
  return more != NULL && atoi(more) > 0 ? count * atoi(more) : count;
}

/* The plan; return this from main. */
static inline int tap_done(void)
{
  printf("1..%d\n", tap_count);
  return tap_failed != 0;
}

#endif
