/* A host that takes only the projection: closest points of a curved face, in C99 and C++. */
#include "tap.h"

#include <libcontact/projection.h>

int main(void)
{
  /* A quadratic face on the cylinder x² + z² = 1, y from 0 to 1; its nodes lie on the cylinder. */
  double s = sqrt(0.5);
  double node[8][3] = {{-s, 0, s}, {s, 0, s},   {s, 1, s}, {-s, 1, s},
                       {0, 0, 1},  {s, 0.5, s}, {0, 1, 1}, {-s, 0.5, s}};
  double point[3] = {0.0, 0.25, 1.5};
  ct_face face;
  ct_projection closest;
  ct_project_options options = ct_project_options_default();
  ct_status status;
  face.kind = CT_Q8;
  for (int a = 0; a < 8; a++)
    for (int c = 0; c < 3; c++) face.node[a][c] = node[a][c];

  status = ct_project(&face, point, &options, &closest, NULL);
  tap_ok(status == CT_OK, "the projection converges: %s", ct_status_name(status));
  tap_close(closest.distance, 0.5, 1e-12, "distance of a point above the top of the cylinder");
  tap_close(closest.xi[0], 0.0, 1e-9, "xi_1 of its closest point");
  tap_close(closest.xi[1], -0.5, 1e-9, "xi_2 of its closest point");
  tap_ok(closest.where == CT_INTERIOR, "the closest point lies inside the face");

  point[1] = -1.0;
  status = ct_project(&face, point, NULL, &closest, NULL);
  tap_ok(status == CT_OK && closest.where == CT_EDGE,
         "a point beyond the end is nearest to an edge");
  tap_close(closest.distance, sqrt(1.25), 1e-12, "its distance");

  point[0] = sqrt(-1.0);
  status = ct_project(&face, point, NULL, &closest, NULL);
  tap_ok(status == CT_INVALID && closest.distance != closest.distance,
         "NaN in, a status and NaN out");
  return tap_done();
}
