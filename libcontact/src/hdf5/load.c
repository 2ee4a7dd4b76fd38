#include "hdf5_internal.h"

#include <string.h>

#ifdef CT_HDF5_LOADED

ct_hdf5_table ct_hdf5;

/* What `find` returns is a function or an id; ISO C has no conversion to the former. */
static int set(void *member, const void *found)
{
  memcpy(member, &found, sizeof found);
  return found != NULL;
}

int ct_hdf5_load(ct_hdf5_find *find)
{
  int all = 1;
  unsigned major = 0, minor = 0, release = 0;
#define SET(type, name, arguments) all = set(&ct_hdf5.name##_call, find(#name)) && all;
#define SET_ID(name) all = set(&ct_hdf5.name, find(#name)) && all;
  ct_hdf5 = (ct_hdf5_table){0};
  CT_HDF5_TABLE(SET, SET_ID)
  ct_hdf5.is_loaded = all && H5open() >= 0 && H5get_libversion(&major, &minor, &release) >= 0 &&
                      (major > 1 || minor >= 14);
  return ct_hdf5.is_loaded;
}

#else

int ct_hdf5_load(ct_hdf5_find *find)
{
  (void)find;
  return 1;
}

#endif
