/* Inner rules of a pass: which points the face of the last step settles alone, and how far a motion
 * can change a gap; and the gaps before a step, from which the account of admitted points follows.
 */
#include "../../libcontact/src/contact/admission.c"
#include "../../libcontact/src/gap/candidates.c"
#include "../../libcontact/src/gap/pass.c"
#include "../../libcontact/src/gap/warm.c"

#include "tap.h"

/* One point of eight, open, with nothing near (eq:warm-lanes): settled inside the face and nearer
 * than contact looks, not on an edge or a corner, nor beyond; nor where the box of another face is
 * as near. */
static void settled(void)
{
  static const double place[3] = {-1.0, 0.4, 1.0};
  ct_side_fixed fixed = {.rule.count = 1};
  ct_point none = {.other = -1};
  ct_search search = {.size = 1.0};
  ct_side side = {.fixed = &fixed, .search = &search, .points = &none};
  const ct_pass p = {.side = &side, .project = ct_project_options_default(), .depth = 0.5};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 4; k++) {
        block b = {.xi = {[3] = place[i], [11] = place[j]}};
        b.gap[3] = k % 2 ? 0.501 : 0.499;
        b.rival[3] = k / 2;
        tap_ok((find_settled(&p, &b, 1u << 3) != 0) == (i == 1 && j == 1 && k == 0),
               "closest point (%g, %g) at %g, %s", place[i], place[j], b.gap[3],
               k / 2 ? "with a rival" : "alone");
      }
}

/* Eight such points are settled together, unless one of them is on an edge, comes into contact, has
 * jumped, coincides with its closest point or has a rival. */
static void together(void)
{
  ct_search search = {.size = 1.0};
  ct_side side = {.search = &search};
  const ct_pass p = {.side = &side, .project = ct_project_options_default(), .depth = 0.5};
  int wrong = 0;
  for (int l = 0; l < CT_WARM; l++)
    for (int k = 0; k < 7; k++) {
      block b = {.rivals = k == 6};
      for (int i = 0; i < CT_WARM; i++) b.gap[i] = 0.1, b.last[i] = state_of(0.1);
      if (k == 1) b.xi[l] = 1.0;
      if (k == 2 || k == 3) b.gap[l] = -0.1;
      if (k == 3) b.last[l] = state_of(-0.1);
      if (k == 4) b.gap[l] = 1e-13;
      if (k == 5) memcpy(&b.last[l], (int32_t[]){CT_POINT_OUTSIDE, CT_POINT_JUMPED}, 8);
      wrong += is_steady(&p, &b) != (k == 0 || k == 3);
    }
  tap_ok(wrong == 0, "eight points that are settled together, or not");
}

/* The gap vector of a touching point is rounding alone: its row has the normal of the face, and its
 * motion is the one along that (eq:admitted-store). */
static void touching(void)
{
  ct_search search = {.size = 1.0};
  ct_side side = {.search = &search};
  const ct_pass p = {.side = &side};
  ct_point point = {.other = 0};
  block b = {.number = 0};
  b.gap[3] = 1e-17, b.d[3] = 1e-17, b.direction[3] = -1.0, b.normal[16 + 3] = 1.0;
  b.along[3] = b.own[3] = 0.7, b.own[16 + 3] = 0.5, b.back[16 + 3] = 0.3;
  write_lanes(&b, 4, 1, 3, &point);
  write_state(&p, &b, 3, &point);
  tap_ok(point.row.normal[0] == 0.0 && point.row.normal[2] == 1.0 && point.along == 0.5 - 0.3,
         "a touching point has the normal of the face, and the motion along it (%g)", point.along);
}

/* A point moves by (0.3, 0.1, 0), one node of the other face by (0, 0.5, 0.2), the others stand
 * still: m = S |(0.3, -0.4, -0.2)| and 1e-6 of the size (eq:gap-bound). */
static void motion(int per)
{
  int32_t nodes[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  double own[24], theirs[24] = {[10] = 0.5, [11] = 0.2};
  for (int i = 0; i < 24; i++) own[i] = i % 3 == 0 ? 0.3 : i % 3 == 1 ? 0.1 : 0.0;
  ct_search search = {.per = per, .edges = 4, .faces = nodes, .size = 40.0};
  ct_side_fixed fixed = {.rule.count = 1};
  ct_point point = {.other = -1};
  double N[8] = {0.0};
  ct_segment_shape(per == 4 ? CT_Q4 : CT_Q8, (double[2]){0.3, -0.6}, N);
  point.row.own_shape = N;
  ct_side side = {.fixed = &fixed, .search = &search, .points = &point, .moved = own},
          other = {.search = &search, .moved = theirs};
  const ct_pass p = {.side = &side, .other = &other};
  tap_close(motion_over(&p, 0, 0), (per == 8 ? 3.0 : 1.0) * sqrt(0.29) + 40e-6, 1e-12,
            "a motion past a face of %d nodes", per);
}

/* A vector of the length 3, turned by an angle from z in the plane of x and z. */
static void turned(double degrees, double out[3])
{
  double angle = degrees * acos(-1.0) / 180.0;
  out[0] = 3.0 * sin(angle), out[1] = 0.0, out[2] = 3.0 * cos(angle);
}

/* A point with the normal z, and places whose normals are turned from it: one looks across from
 * 60° on (eq:self-adjacent), faces the point where the cosine is below -1/4, and is on the far side
 * of a last place at 150° or at 60° if it is more than 120° from that, or more than 60° and not
 * across (eq:far-side). */
static void directions(void)
{
  static const double own[3] = {0.0, 0.0, 1.0};
  int32_t nodes[4] = {0, 1, 2, 3};
  // The last place looks along x.
  double x[12] = {0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1};
  ct_search search = {.kind = CT_Q4, .per = 4, .edges = 4, .faces = nodes, .x = x, .size = 1.0};
  ct_side other = {.search = &search};
  const ct_pass p = {.other = &other};
  const ct_point was = {.other = 0}, new = {.other = -1};
  int across = 0, faces = 0, far = 0;
  for (double degrees = -179.5; degrees < 180.0; degrees += 1.0) {
    double normal[3], cosine = cos(degrees * acos(-1.0) / 180.0);
    turned(degrees, normal);
    across += ct_pass_faces_across(own, normal) != (fabs(degrees) > 60.0);
    faces += faces_point(&p, &new, own, normal) != (cosine < -0.25);
    faces += faces_point(&p, &was, own, normal) !=
             (cosine < -0.25 || (fabs(degrees) > 60.0 && fabs(degrees - 90.0) < 60.0));
    for (int k = 0; k < 2; k++) {
      double last[3], place = k == 0 ? 150.0 : 60.0, apart = fabs(degrees - place);
      turned(place, last);
      for (int c = 0; c < 3; c++) last[c] /= 3.0;
      apart = fmin(apart, 360.0 - apart);
      far += is_far(own, last, normal) != (apart > 120.0 || (apart > 60.0 && fabs(degrees) < 60.0));
    }
  }
  tap_ok(across == 0, "places that look across");
  tap_ok(faces == 0, "places that face a point");
  tap_ok(far == 0, "places on the far side");
}

enum { SQUARES = 30 };

/* Level squares at random places. */
static void new_squares(int trial, ct_bounds boxes[SQUARES], double x[12 * SQUARES],
                        int32_t nodes[4 * SQUARES])
{
  for (int f = 0; f < SQUARES; f++)
    for (int c = 0; c < 3; c++) {
      const double random = 0.5 + 0.5 * sin(1e4 * sin(90.0 * trial + 3.0 * f + c));
      boxes[f].low[c] = c < 2 ? 2.0 * random - 0.6 : 0.6 * random - 0.4;
      if (c == 2 && trial % 4 == 3) boxes[f].low[c] -= 0.8;
      boxes[f].high[c] = boxes[f].low[c] + (c < 2 ? 0.3 : 0.0);
      for (int a = 0; a < 4; a++) {
        const int high = c == 0 ? a == 1 || a == 2 : a >= 2;
        nodes[4 * f + a] = 4 * f + a;
        x[3 * (4 * f + a) + c] = high ? boxes[f].high[c] : boxes[f].low[c];
      }
    }
}

/* Least distance of a point from the squares but the first. */
static double nearest_rival(const ct_bounds boxes[SQUARES], const block *b, int l)
{
  const double at[3] = {b->points[l], b->points[8 + l], b->points[16 + l]};
  double least = INFINITY;
  for (int f = 1; f < SQUARES; f++) least = fmin(least, ct_bounds_distance(&boxes[f], at));
  return least;
}

/* Eight points of one face and many squares, those within the skin listed first: the rivals are
 * those of a loop over all squares (eq:warm-lanes, eq:skin); also where the distance of all from
 * the points is known from before a motion of 0.1 (eq:rival-distance). */
static void rivals(void)
{
  int wrong = 0, found = 0, skipped = 0, trials = 300;
  for (int trial = 0; trial < trials; trial++) {
    ct_bounds boxes[SQUARES], grown = {{-0.2, -0.2, -0.2}, {1.2, 1.2, 0.3}};
    int32_t list[SQUARES], ends[2] = {0, SQUARES}, near_end = 0, nodes[4 * SQUARES];
    double x[12 * SQUARES];
    new_squares(trial, boxes, x, nodes);
    for (int pass = 0; pass < 2; pass++)
      for (int f = 0, next = pass * near_end; f < SQUARES; f++)
        if (ct_bounds_apart(&boxes[f], &grown) == pass) list[next++] = f, near_end += !pass;
    ct_search search = {
        .kind = CT_Q4, .per = 4, .edges = 4, .faces = nodes, .x = x, .boxes = boxes};
    int32_t met[CT_WARM];
    double distant[CT_WARM];
    ct_side side = {.candidate_first = ends,
                    .candidates = list,
                    .near_end = &near_end,
                    .met = met,
                    .distant = distant},
            other = {.search = &search};
    const ct_pass p = {.side = &side, .other = &other, .depth = 10.0, .skin = 0.2, .since = 0.1};
    block b = {.count = CT_WARM};
    const double most = 0.8 * pow(0.5, trial % 6);
    int all = 0;
    for (int l = 0; l < CT_WARM; l++) {
      b.gap[l] = most * (1 + l) / CT_WARM;
      for (int c = 0; c < 3; c++)
        b.points[CT_WARM * c + l] = (c < 2 ? 0.5 : 0.05) * (1.0 + sin(7.0 * trial + 5.0 * l + c));
    }
    for (int l = 0; l < CT_WARM; l++) {
      met[l] = trial % 2 ? 0 : -1;
      distant[l] = nearest_rival(boxes, &b, l) + 0.1;
      all += trial % 2 && distant[l] > 0.1 + most;
    }
    skipped += all == CT_WARM;
    find_rivals(&p, &b);
    for (int l = 0; l < CT_WARM; l++) {
      const int near = nearest_rival(boxes, &b, l) <= b.gap[l];
      wrong += (b.rival[l] != 0) != near;
      found += near;
    }
  }
  tap_ok(skipped > 5, "rivals that the distance excludes: %d times", skipped);
  tap_ok(wrong == 0 && found > 100 && found < 8 * trials - 100,
         "rivals are those among all squares: %d of %d, %d wrong", found, 8 * trials, wrong);
}

/* Last gap of a point of a face with `per` nodes over one with `theirs` nodes, against the sums
 * over both faces (eq:admitted-store). */
static void last_gap(int per, int theirs)
{
  static const ct_partner_calls surfaces = {.label = "contact"};
  int32_t nodes[8] = {3, 7, 1, 0, 6, 2, 5, 4};
  double u[2][25] = {{0.0}}, N[2][8] = {{0.0}}, motion = 0.0;
  for (int i = 0; i < 48; i++) u[i / 24][i % 24] = sin(1.0 + i * i);
  for (int i = 0; i < 16; i++)
    N[i / 8][i % 8] = i % 8 < (i < 8 ? per : theirs) ? cos(3.0 * i) : 0.0;
  ct_search search[2] = {{.per = per, .faces = nodes}, {.per = theirs, .faces = nodes}};
  ct_side_fixed side = {.rule.count = 1, .point_count = 1};
  ct_point point = {
      .other = 0, .along = NAN, .closed = 0.3, .row = {.gap = -0.1, .normal = {0.6, 0.0, 0.8}}};
  memcpy(point.N, N[1], sizeof point.N);
  point.row.own_shape = N[0];
  ct_contact_fixed fixed = {.partner = &surfaces, .gaps = {.sides = 2}};
  ct_contact contact = {.fixed = &fixed, .gaps = {.fixed = &fixed.gaps}};
  for (int s = 0; s < 2; s++)
    contact.gaps.side[s] =
        (ct_side){.fixed = &side, .search = &search[s], .points = &point, .moved = u[s]};
  find_before(&contact, 0, &point);
  for (int a = 0; a < 8; a++)
    for (int s = 0; s < 2; s++)
      motion +=
          (s ? -1.0 : 1.0) * N[s][a] * (0.6 * u[s][3 * nodes[a]] + 0.8 * u[s][3 * nodes[a] + 2]);
  tap_close(point.row.before, -0.1 + 0.3 - motion, 1e-14,
            "the last gap of a point of %d nodes over %d", per, theirs);
}

/* Motions of eight points of faces with `per` nodes, each over a face or all over one, with the
 * bits of single points (eq:admitted-store). */
static void motions(int per, int one)
{
  enum { NODES = 24, POINTS = 27 };
  static ct_side_fixed fixed;
  static ct_point point[POINTS];
  const int count = per == 4 ? 4 : 9;
  int32_t nodes[NODES];
  double u[2][3 * NODES + 1], wrong = 0.0;
  for (int i = 0; i < NODES; i++) nodes[i] = (7 * i + 5) % NODES;
  for (int i = 0; i <= 3 * NODES; i++) u[0][i] = sin(1.0 + i * i), u[1][i] = cos(2.0 + i * i);
  ct_search search = {.per = per, .edges = 4, .faces = nodes, .x = u[0]};
  fixed.rule.count = count, fixed.point_count = 3 * count;
  for (int i = 0; i < 8 * count; i++)
    fixed.N[i / 8][i % 8] = fixed.across[i % 8][i / 8] = sin(3.0 * i);
  static const ct_partner_calls surfaces = {.label = "contact"};
  ct_contact_fixed both = {.partner = &surfaces, .gaps = {.sides = 2}};
  ct_contact contact = {.fixed = &both, .gaps = {.fixed = &both.gaps}};
  for (int s = 0; s < 2; s++)
    contact.gaps.side[s] =
        (ct_side){.fixed = &fixed, .search = &search, .points = point, .moved = u[s]};
  const ct_pass p = {.side = &contact.gaps.side[0], .other = &contact.gaps.side[1]};
  for (int first = 0; first + CT_WARM <= 3 * count; first++) {
    block b = {.one = {one, one}};
    for (int l = 0; l < CT_WARM; l++) {
      b.face[l] = (first + l) / count, b.q[l] = (first + l) % count;
      b.target[l] = one ? 1 : (first + l) % 3;
      for (int a = 0; a < per; a++) b.N[8 * a + l] = cos(first + 5.0 * a + l);
      for (int c = 0; c < 3; c++) b.direction[8 * c + l] = sin(first + 2.0 * c + l);
    }
    for (int l = 0; l < CT_WARM; l += 4) load_own(&p, per, b.face[l] == b.face[l + 3], l, &b);
    find_motion(&p, per, &b);
    for (int l = 0; l < CT_WARM; l++) {
      ct_point *at = &point[first + l];
      at->other = b.target[l], at->row.own_shape = fixed.N[b.q[l]];
      for (int a = 0; a < per; a++) at->N[a] = b.N[8 * a + l];
      for (int c = 0; c < 3; c++) at->row.normal[c] = b.direction[8 * c + l];
      wrong += b.along[l] != motion_along(&contact, 0, at);
    }
  }
  tap_ok(wrong == 0.0, "motions of eight points of %d nodes over %s", per,
         one ? "one face" : "three faces");
}

/* Distance of the origin from a square whose middle is in a random direction. */
static double square_near(int seed, double x[12])
{
  const ct_project_options options = ct_project_options_default();
  const double y[3] = {0.0};
  ct_face face = {.kind = CT_Q4};
  ct_projection closest;
  double e[2][3];
  for (int k = 0; k < 2; k++)
    for (int c = 0; c < 3; c++) e[k][c] = 0.2 * sin(1e4 * sin(70.0 * seed + 3.0 * k + c));
  for (int a = 0; a < 4; a++)
    for (int c = 0; c < 3; c++)
      face.node[a][c] = x[3 * a + c] =
          6.0 * e[0][c] + (a == 1 || a == 2 ? e[0][c] : -e[0][c]) + (a > 1 ? e[1][c] : -e[1][c]);
  return ct_project(&face, y, &options, &closest, NULL) == CT_OK ? closest.distance : NAN;
}

/* A point that meets none of some faces, and each of these as it moves toward the point by at most
 * 0.13, which is split into motions before and after the search: where the point is left alone, no
 * face is within the search distance (eq:clear-distance). */
static void alone(void)
{
  enum { FACES = 2 };
  int wrong = 0, some = 0, searched = 0, near = 0;
  for (int trial = 0; trial < 4000; trial++) {
    int32_t nodes[4 * FACES] = {0, 1, 2, 3, 4, 5, 6, 7}, list[FACES] = {0, 1}, ends[2] = {0, FACES},
                      met = -1;
    double distant = 0.0, x[12 * FACES], origin[13] = {0.0}, distance = INFINITY;
    const double y[3] = {0.0}, place = 0.01 * (trial % 14);
    ct_bounds boxes[FACES];
    ct_search own = {.per = 4, .edges = 4, .faces = nodes, .x = origin},
              search = {
                  .kind = CT_Q4, .per = 4, .edges = 4, .faces = nodes, .x = x, .boxes = boxes};
    ct_side_fixed fixed = {.rule.count = 1, .N = {{0.25, 0.25, 0.25, 0.25}}};
    ct_point point = {.other = trial % 3 == 0 ? 0 : -1, .status = CT_POINT_OUTSIDE};
    ct_side side = {.fixed = &fixed,
                    .search = &own,
                    .points = &point,
                    .candidate_first = ends,
                    .candidates = list,
                    .met = &met,
                    .distant = &distant},
            other = {.search = &search};
    for (int f = 0; f < FACES; f++) {
      ct_face face;
      distance = fmin(distance, square_near(trial + 4000 * f, &x[12 * f]));
      ct_search_face(&search, f, &face);
      boxes[f] = ct_face_bounds(&face);
    }
    ct_pass p = {.side = &side,
                 .other = &other,
                 .project = ct_project_options_default(),
                 .depth = 0.9,
                 .since = 0.13 - place};
    nearest best;
    find_nearest(&p, 0, y, 0, &best);
    if (best.face != INT32_MAX) continue;
    searched++;
    keep_clear(&p, 0, best.clear);
    point.other = -1;
    p.since = place;
    const int left = is_alone(&p, 0);
    some += left;
    near += distance - 0.13 <= p.depth;
    wrong += left && distance - 0.13 <= p.depth;
  }
  tap_ok(wrong == 0 && some > 100 && near > 100,
         "%d points of %d are left alone, %d of them may have come near", some, searched, near);
}

int main(void)
{
  static const int PER[4] = {3, 4, 6, 8};
  rivals();
  alone();
  for (int i = 0; i < 16; i++) last_gap(PER[i / 4], PER[i % 4]);
  for (int i = 0; i < 4; i++) motions(i < 2 ? 4 : 8, i % 2);
  directions();
  settled();
  together();
  touching();
  motion(4);
  motion(8);
  return tap_done();
}
