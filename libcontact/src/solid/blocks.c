/* The largest frequency of a body: by its elements, and in a box of equal bricks by blocks of two
 * and three of them along each side. */
#include "below.h"
#include "blocks.h"
#include "element.h"

#include "../base/error.h"
#include "../base/memory.h"
#include "../base/threads.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

enum { SIZE = CT_ELEMENT_SIZE, DOFS = 24 };

/* Elements are equal if their nodes differ by at most this fraction of the size of the body. */
static const double ALIKE = 1e-12;

/* Positions of the nodes of a hex8. */
static const int CORNER[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                 {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

/* Edges of the bricks of a rotated body, all of them shifted copies of the first one; returns 0 if
 * they are not rectangular or not equal. */
static int find_edges(const ct_mesh *mesh, double size, ct_solid_box *b)
{
  static const int END[3] = {1, 3, 4};
  double x[20][3], e[3][3];
  ct_solid_load_element(mesh, 0, mesh->nodes, x);
  for (int d = 0; d < 3; d++) {
    for (int c = 0; c < 3; c++) e[d][c] = x[END[d]][c] - x[0][c];
    b->edge[d] = sqrt(ct_vector_dot(e[d], e[d]));
    if (!(b->edge[d] > 0.0)) return 0;
    for (int c = 0; c < 3; c++) b->axis[d][c] = e[d][c] / b->edge[d];
    for (int k = 0; k < d; k++)
      if (!(fabs(ct_vector_dot(b->axis[k], e[d])) <= ALIKE * size)) return 0;
  }
  for (int32_t i = 0; i < mesh->element_count; i++) {
    ct_solid_load_element(mesh, i, mesh->nodes, x);
    for (int a = 1; a < 8; a++)
      for (int c = 0; c < 3; c++) {
        double want = (CORNER[a][0] * e[0][c] + CORNER[a][1] * e[1][c]) + CORNER[a][2] * e[2][c];
        if (!(fabs((x[a][c] - x[0][c]) - want) <= ALIKE * size)) return 0;
      }
  }
  return 1;
}

/* Number of the cell with its first corner at a point, of a box that begins at `low` along its
 * edges. */
static int64_t cell_at(const ct_solid_box *b, const double low[3], const double *x)
{
  int64_t i[3];
  for (int d = 0; d < 3; d++)
    i[d] = (int64_t)((ct_vector_dot(b->axis[d], x) - low[d]) / b->edge[d] + 0.5);
  return i[0] + b->cells[0] * (i[1] + b->cells[1] * i[2]);
}

/* Whether a body is a full box of one material, and its description. */
static ct_status find_box(const ct_solid_part *part, ct_solid_box *b, ct_error *error)
{
  const ct_mesh *mesh = part->mesh;
  double low[3], high[3], elements = 1.0, nodes = 1.0;
  *b = (ct_solid_box){.axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  ct_mesh_bounds(mesh, low, high);
  double size = fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
  if (!ct_brick_facts_of(mesh->kind)->trilinear || part->materials != NULL) return CT_OK;
  b->aligned = part->box;
  memcpy(b->edge, part->edge, sizeof b->edge);
  if (!part->box && !find_edges(mesh, size, b)) return CT_OK;
  for (int d = 0; d < 3; d++) {
    if (!b->aligned) low[d] = INFINITY, high[d] = -INFINITY;
    for (int32_t n = 0; !b->aligned && n < mesh->node_count; n++) {
      double at = ct_vector_dot(b->axis[d], &mesh->nodes[3 * (size_t)n]);
      low[d] = fmin(low[d], at);
      high[d] = fmax(high[d], at);
    }
    double count = floor((high[d] - low[d]) / b->edge[d] + 0.5);
    elements *= count;
    nodes *= count + 1.0;
  }
  if (elements != mesh->element_count || nodes != mesh->node_count) return CT_OK;
  // -- As many elements as cells: the box is full unless two of them share a cell
  char *taken = ct_allocate((size_t)mesh->element_count, 1);
  if (taken == NULL) return CT_NO_MEMORY(error, "the stable step");
  for (int d = 0; d < 3; d++) b->cells[d] = (int32_t)floor((high[d] - low[d]) / b->edge[d] + 0.5);
  int full = 1;
  for (int32_t e = 0; full && e < mesh->element_count; e++) {
    char *cell = &taken[cell_at(b, low, &mesh->nodes[3 * (size_t)mesh->elements[8 * (size_t)e]])];
    full = !*cell;
    *cell = 1;
  }
  ct_release(taken);
  if (!full) b->cells[0] = 0;
  return CT_OK;
}

/* A block, and its motions that are even (1) or odd (-1) about its three middle planes. */
typedef struct block {
  int size[3], parity[3];
  const int *fixed;
} block;

/* The degree of freedom of the block's corner with which component c of a node moves, and its sign;
 * -1: it does not move. */
static int fold(const block *b, const int node[3], int c, double *sign)
{
  int at = 0;
  *sign = 1.0;
  for (int d = 0; d < 3; d++) {
    // Reflection in a plane reverses the component normal to it.
    // σ = -π_d for c = d, else π_d (eq:block-fold)
    int image = d == c ? -b->parity[d] : b->parity[d], mirrored = b->size[d] - node[d];
    if (node[d] == mirrored && image < 0) return -1;
    if (node[d] > mirrored) *sign *= image;
    at = 2 * at + (node[d] < mirrored ? node[d] : mirrored);
  }
  return b->fixed[c] ? -1 : 3 * at + c;
}

/* Add an element, which represents `images` equal ones, to the stiffness and the masses of the
 * corner. */
static void add_element(const block *b, const int cell[3], double images, double K[SIZE][SIZE],
                        const double *mass, double A[SIZE][SIZE], double m[SIZE])
{
  int dof[DOFS];
  double sign[DOFS];
  for (int i = 0; i < DOFS; i++) {
    int node[3];
    for (int d = 0; d < 3; d++) node[d] = cell[d] + CORNER[i / 3][d];
    dof[i] = fold(b, node, i % 3, &sign[i]);
    if (dof[i] >= 0) m[dof[i]] += images * mass[i / 3];
  }
  for (int i = 0; i < DOFS; i++)
    for (int j = 0; j < DOFS; j++)
      if (dof[i] >= 0 && dof[j] >= 0)
        A[dof[i]][dof[j]] += images * sign[i] * sign[j] * (i >= j ? K[i][j] : K[j][i]);
}

/* Largest eigenvalue of the motions of one parity. */
static ct_status parity_omega2_bound(const block *b, double K[SIZE][SIZE], const double *mass,
                                     double *omega_squared, ct_error *error)
{
  double A[SIZE][SIZE] = {{0.0}}, m[SIZE] = {0.0};
  int cell[3], count = 0;
  // -- The elements of one corner; one in the middle is its own image
  for (cell[2] = 0; 2 * cell[2] < b->size[2]; cell[2]++)
    for (cell[1] = 0; 2 * cell[1] < b->size[1]; cell[1]++)
      for (cell[0] = 0; 2 * cell[0] < b->size[0]; cell[0]++) {
        double images = 1.0;
        for (int d = 0; d < 3; d++)
          if (2 * cell[d] + 1 < b->size[d]) images *= 2.0;
        add_element(b, cell, images, K, mass, A, m);
      }
  // -- Leave out what does not move
  int kept[DOFS];
  for (int i = 0; i < DOFS; i++) {
    if (m[i] == 0.0) continue;
    kept[count] = i;
    m[count] = m[i];
    for (int j = 0; j <= count; j++) A[count][j] = A[i][kept[j]];
    count++;
  }
  *omega_squared = 0.0;
  return count > 0 ? ct_largest_eigenvalue(count, m, A, omega_squared, error) : CT_OK;
}

/* Sizes of the blocks that make up a row of cells: only twos or only threes if possible, else both.
 */
static void sizes_of(int32_t cells, int *first, int *last)
{
  *first = cells == 1 ? 1 : cells % 2 == 0 || cells % 3 != 0 ? 2 : 3;
  *last = cells == 1 ? 1 : cells % 2 == 0 ? 2 : 3;
}

/* Bound on the largest eigenvalue of M⁻¹K of a box with these numbers of cells, from the lower half
 * of K of one element and the masses of its nodes. */
static ct_status blocks_omega2_bound(const int32_t cells[3], const int fixed[3],
                                     double K[SIZE][SIZE], const double *mass,
                                     double *omega_squared, ct_error *error)
{
  int first[3], last[3];
  block b = {.fixed = fixed};
  *omega_squared = 0.0;
  for (int d = 0; d < 3; d++) sizes_of(cells[d], &first[d], &last[d]);
  // -- The fastest motion of all blocks, of each parity on its own
  for (b.size[0] = first[0]; b.size[0] <= last[0]; b.size[0]++)
    for (b.size[1] = first[1]; b.size[1] <= last[1]; b.size[1]++)
      for (b.size[2] = first[2]; b.size[2] <= last[2]; b.size[2]++)
        for (int k = 0; k < 8; k++) {
          double w;
          for (int d = 0; d < 3; d++) b.parity[d] = k >> d & 1 ? -1 : 1;
          ct_status status = parity_omega2_bound(&b, K, mass, &w, error);
          if (status != CT_OK) return status;
          *omega_squared = fmax(*omega_squared, w); // (eq:block-bound)
        }
  return CT_OK;
}

/* Whether two elements are translations of each other, to 1e-12 of their size: they then have one
 * eigenvalue. */
static int same_shape(int per, double x[20][3], double y[20][3])
{
  double size = 0.0, difference = 0.0;
  for (int a = 1; a < per; a++)
    for (int c = 0; c < 3; c++) {
      size = fmax(size, fabs(x[a][c] - x[0][c]));
      difference = fmax(difference, fabs((x[a][c] - x[0][c]) - (y[a][c] - y[0][c])));
    }
  return difference <= ALIKE * size;
}

/* Lower half of the stiffness of one element, and the masses of its nodes. */
static ct_status element_matrices(const ct_solid_part *part, int32_t element, double x[20][3],
                                  double A[SIZE][SIZE], double m[20], ct_error *error)
{
  const ct_material *material = ct_part_material(part, element);
  ct_status status =
      ct_mass_element(part->mesh->kind, &x[0][0], material->density, part->lumping, m, error);
  if (status != CT_OK) return status;
  return part->kernel == CT_KERNEL_REDUCED
             ? ct_reduced_stiffness(&x[0][0], material, part->hourglass, A, error)
             : ct_element_stiffness(part->mesh->kind, &x[0][0], NULL, material, A, error);
}

/* Lower half of the stiffness of a brick of a box, and its masses. The material is isotropic, so a
 * rotated box has the eigenvalues of one along x, y, z. */
static ct_status brick_matrices(const ct_solid_part *part, const ct_solid_box *b,
                                double A[SIZE][SIZE], double m[20], ct_error *error)
{
  double x[20][3];
  for (int a = 0; a < 8; a++)
    for (int d = 0; d < 3; d++) x[a][d] = CORNER[a][d] * b->edge[d];
  return element_matrices(part, 0, x, A, m, error);
}

/* The bound by blocks. Rotated bricks are equal to 12 digits of the size of the body only. */
static ct_status box_omega2_bound(const ct_solid_box *b, double A[SIZE][SIZE], const double *m,
                                  double *omega_squared, ct_error *error)
{
  ct_status status = blocks_omega2_bound(b->cells, b->fixed, A, m, omega_squared, error);
  if (!b->aligned) *omega_squared *= 1.0 + 1e-9;
  return status;
}

ct_status ct_solid_joint_bound(const ct_solid_part *part, double stiffness, double mass,
                               const double *added, double *largest, ct_error *error)
{
  double A[SIZE][SIZE], m[20];
  ct_status status = brick_matrices(part, &part->blocks, A, m, error);
  // -- Δt² K, what other effects add to an element, and bounds of what else there is
  // (eq:joint-bound)
  for (int i = 0; status == CT_OK && i < DOFS; i++)
    for (int j = 0; j <= i; j++)
      A[i][j] = stiffness * A[i][j] + added[DOFS * i + j] + (i == j ? mass * m[i / 3] : 0.0);
  return status == CT_OK ? box_omega2_bound(&part->blocks, A, m, largest, error) : status;
}

/* Whether two elements have one material. */
static int same_material(const ct_solid_part *part, int32_t e, int32_t other)
{
  return memcmp(ct_part_material(part, e), ct_part_material(part, other), sizeof part->material) ==
         0;
}

/* Largest ω² of one element. */
static ct_status element_omega2(const ct_solid_part *part, int32_t element, double x[20][3],
                                const int fixed[3], double *omega_squared, ct_error *error)
{
  double A[SIZE][SIZE], m[20], spread[SIZE];
  int per = ct_brick_node_count(part->mesh->kind);
  ct_status status = element_matrices(part, element, x, A, m, error);
  if (status != CT_OK) return status;
  ct_spread_mass(per, m, fixed, spread);
  return ct_largest_eigenvalue(3 * per, spread, A, omega_squared, error);
}

/* Whether element e lies certainly below `reached`: `below` tells it of the elements of a batch. */
static int surely_below(const ct_solid_part *part, const ct_mass_shapes *at, const int fixed[3],
                        int32_t e, double reached, unsigned *below)
{
  if (part->kernel != CT_KERNEL_REDUCED && e % CT_LANES_COUNT == 0)
    *below = ct_solid_below(part, at, e, fixed, (1.0 - 1e-9) * reached);
  return (int)(*below >> e % CT_LANES_COUNT & 1);
}

/* The largest ω² of the elements first ... last - 1. Those that certainly lie below `reached` need
 * no eigenvalues; the margin is far above round-off, so the result is that of all elements. */
static ct_status share_omega2_bound(const ct_solid_part *part, const ct_mass_shapes *at,
                                    const int fixed[3], int32_t first, int32_t last, double reached,
                                    double *omega_squared, ct_error *error)
{
  const ct_mesh *mesh = part->mesh;
  double x[20][3], before[20][3] = {{0.0}}, w = 0.0;
  unsigned below = 0;
  ct_status status = CT_OK;
  for (int32_t e = first; status == CT_OK && e < last; e++) {
    int low = surely_below(part, at, fixed, e, reached, &below);
    ct_solid_load_element(mesh, e, mesh->nodes, x);
    if (e > first && same_shape(at->per, x, before) && same_material(part, e, e - 1)) continue;
    memcpy(before, x, sizeof before);
    if (low) continue;
    status = element_omega2(part, e, x, fixed, &w, error);
    if (status != CT_OK && error != NULL) error->element = e;
    *omega_squared = fmax(*omega_squared, w); // (eq:element-bound)
    reached = fmax(reached, w);
  }
  return status;
}

/* Fewest elements of a thread, a multiple of the lanes: each takes some thousand operations. */
enum { LEAST_ELEMENTS = 512 };

/* The largest over all elements; that of a stiff one is computed first. */
static ct_status elements_omega2_bound(const ct_solid_part *part, const int fixed[3],
                                       double *omega_squared, ct_error *error)
{
  const ct_mesh *mesh = part->mesh;
  double x[20][3], reached = 0.0, largest = 0.0;
  int32_t count = mesh->element_count, lanes = (count + CT_LANES_COUNT - 1) / CT_LANES_COUNT;
  int failed = 0, threads = ct_threads_for(ct_threads_of(mesh->settings), count, LEAST_ELEMENTS);
  ct_mass_shapes at;
  ct_status status = ct_mass_tabulate(mesh->kind, part->lumping, &at, error);
  if (status != CT_OK) return status;
  if (part->kernel != CT_KERNEL_REDUCED) {
    const int32_t stiffest = ct_solid_stiffest(part, &at);
    ct_solid_load_element(mesh, stiffest, mesh->nodes, x);
    if (element_omega2(part, stiffest, x, fixed, &reached, NULL) != CT_OK) reached = 0.0;
  }
#ifdef _OPENMP
#pragma omp parallel for num_threads(threads) schedule(static, 1) reduction(max : largest) \
    reduction(| : failed) if (threads > 1)
#endif
  for (int share = 0; share < threads; share++) {
    int32_t first = CT_LANES_COUNT * ct_share(lanes, share, threads),
            last = CT_LANES_COUNT * ct_share(lanes, share + 1, threads);
    failed |= share_omega2_bound(part, &at, fixed, first, last < count ? last : count, reached,
                                 &largest, NULL) != CT_OK;
  }
  *omega_squared = largest;
  // Only a single thread finds which bad element is the first.
  return failed ? share_omega2_bound(part, &at, fixed, 0, count, reached, omega_squared, error)
                : CT_OK;
}

ct_status ct_solid_part_omega2_bound(const ct_solid_part *part, const int fixed[3],
                                     ct_solid_box *box, double *omega_squared, ct_error *error)
{
  double A[SIZE][SIZE], m[20];
  *box = (ct_solid_box){.cells = {0}};
  *omega_squared = 0.0;
  ct_status status = part->energies == NULL ? find_box(part, box, error) : CT_OK;
  if (status != CT_OK) return status;
  if (box->cells[0] == 0) return elements_omega2_bound(part, fixed, omega_squared, error);
  for (int c = 0; c < 3; c++) box->fixed[c] = box->aligned && fixed[c];
  status = brick_matrices(part, box, A, m, error);
  return status == CT_OK ? box_omega2_bound(box, A, m, omega_squared, error) : status;
}

ct_status ct_solid_part_nodes_omega2(const ct_solid_part *part, double *omega2, ct_error *error)
{
  static const int FREE[3] = {0, 0, 0};
  const ct_mesh *mesh = part->mesh;
  const int per = ct_brick_node_count(mesh->kind);
  double x[20][3], last[20][3] = {{0.0}}, w = part->omega_squared;
  ct_solid_box b = {.cells = {0}};
  ct_status status = find_box(part, &b, error);
  for (int32_t n = 0; n < mesh->node_count; n++) omega2[n] = 0.0;
  for (int32_t e = 0; status == CT_OK && e < mesh->element_count; e++) {
    ct_solid_load_element(mesh, e, mesh->nodes, x);
    if (b.cells[0] == 0 &&
        (e == 0 || !same_shape(per, x, last) || !same_material(part, e, e - 1))) {
      memcpy(last, x, sizeof last);
      status = element_omega2(part, e, x, FREE, &w, error);
      if (status != CT_OK && error != NULL) error->element = e;
    }
    for (int a = 0; a < per; a++) {
      double *own = &omega2[mesh->elements[(size_t)(per * e + a)]];
      *own = fmax(*own, w);
    }
  }
  return status;
}
