/* The point of a twisted face that is closest to a given point: the smallest host of the library.
 */
#include <libcontact.h>
#include <stdio.h>

int main(void)
{
  ct_face face = {CT_Q4, {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0.5}}};
  double point[3] = {0.2, 0.3, 1.0};
  ct_projection closest;
  ct_status status = ct_project(&face, point, NULL, &closest, NULL);
  printf("%s: distance %.6f at xi = (%.6f, %.6f)\n", ct_status_name(status), closest.distance,
         closest.xi[0], closest.xi[1]);
  return status != CT_OK;
}
