/* The library in a page: what the sources of this folder share. A page has one scene at a time, and
 * JavaScript reads and writes arrays in the memory of the module. */
#ifndef LABORATORY_MODULE_H
#define LABORATORY_MODULE_H

#include <libcontact.h>

/* A call of JavaScript. */
#ifdef __wasm__
#define EXPORT(name) __attribute__((export_name(#name)))
#else
#define EXPORT(name)
#endif

/* The scene of the page and its run. */
typedef struct laboratory {
  ct_scene *scene;
  const ct_problem *problem;
  ct_state *state;
  ct_probes *probes;
  /* Whole number of steps until the end. */
  int64_t step_count;
  ct_stable_step stable;
} laboratory;

extern laboratory page;
/* Of the last call that failed. */
extern ct_error page_error;

/* An array of at least `count` doubles for input or output; its content is lost when it grows. Null
 * without memory. */
double *numbers(int32_t count);

#endif
