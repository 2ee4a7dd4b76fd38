/* What a host with its own time loop needs: closest points, contact, obstacles, friction. */
#include <libcontact/contact.h>
