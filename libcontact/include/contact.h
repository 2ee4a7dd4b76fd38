/* The older name of <libcontact.h>. */
#include <libcontact.h>
