/* The Bloch problem: waves in an infinite mesh of equal bricks, from the matrices of one brick. */
#include "bloch.h"

#include "../base/error.h"
#include "../base/vector.h"

#include <math.h>
#include <string.h>

enum { SIZE = CT_CELL_SIZE };

/* Positions of the nodes of the brick, in edges, and their families. */
static void place_nodes(ct_bloch *bloch, ct_brick_kind kind, const double size[3])
{
  static const int CORNER[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                   {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  static const int EDGE[12][2] = {{0, 1}, {1, 2}, {3, 2}, {0, 3}, {4, 5}, {5, 6},
                                  {7, 6}, {4, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  bloch->per = ct_brick_node_count(kind);
  bloch->families = ct_brick_facts_of(kind)->cell_nodes;
  for (int a = 0; a < bloch->per; a++) {
    const int *low = CORNER[a < 8 ? a : EDGE[a - 8][0]], *high = CORNER[a < 8 ? a : EDGE[a - 8][1]];
    bloch->family[a] = 0;
    for (int d = 0; d < 3; d++) {
      bloch->x[a][d] = 0.5 * size[d] * (low[d] + high[d]);
      if (low[d] != high[d]) bloch->family[a] = 1 + d;
    }
  }
}

/* M_ab = ∫ ρ N_a N_b dV of the brick. */
static void consistent_mass(ct_bloch *bloch, ct_brick_kind kind)
{
  ct_rule rule;
  ct_rule_brick(kind, &rule);
  for (int q = 0; q < rule.count; q++) {
    double N[20];
    ct_brick_shape(kind, rule.xi[q], N);
    for (int a = 0; a < bloch->per; a++)
      for (int b = 0; b < bloch->per; b++)
        bloch->M[a][b] += bloch->mass / 8.0 * rule.weight[q] * N[a] * N[b];
  }
}

ct_status ct_bloch_init(const ct_dispersion_def *def, ct_bloch *bloch, ct_error *error)
{
  double lumped[20];
  memset(bloch, 0, sizeof *bloch);
  if (ct_brick_node_count(def->kind) == 0)
    return CT_REFUSE(error, "dispersion: there is no brick of the kind %d", (int)def->kind);
  for (int d = 0; d < 3; d++)
    if (!(def->size[d] > 0.0 && def->size[d] < CT_LARGEST_LENGTH))
      return CT_REFUSE(error, "dispersion: size[%d] = %g is not positive and finite", d,
                       def->size[d]);
  if ((int)def->mass < CT_MASS_LUMPED || (int)def->mass > CT_MASS_CONSISTENT)
    return CT_REFUSE(error, "dispersion: there is no mass form %d", (int)def->mass);
  ct_status status = ct_material_check(&def->material, error);
  if (status != CT_OK) return status;
  place_nodes(bloch, def->kind, def->size);
  const int n = 3 * bloch->per;
  bloch->mass = def->material.density * (def->size[0] * def->size[1]) * def->size[2];
  status = ct_element_stiffness(def->kind, &bloch->x[0][0], NULL, &def->material, bloch->K, error);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) bloch->K[j][i] = bloch->K[i][j];
  if (def->mass == CT_MASS_CONSISTENT) {
    consistent_mass(bloch, def->kind);
    return status;
  }
  if (status == CT_OK)
    status = ct_mass_element(def->kind, &bloch->x[0][0], def->material.density, CT_LUMP_DEFAULT,
                             lumped, error);
  for (int a = 0; status == CT_OK && a < bloch->per; a++) bloch->M[a][a] = lumped[a];
  return status;
}

/* Phase between two nodes, k·(x_a - x_b), and its derivative. */
static double phase(const ct_bloch *bloch, const double k[3], int a, int b, double r[3])
{
  for (int d = 0; d < 3; d++) r[d] = bloch->x[a][d] - bloch->x[b][d];
  return ct_vector_dot(k, r);
}

void ct_bloch_mass(const ct_bloch *bloch, const double k[3], double M[4][4])
{
  double r[3];
  memset(M, 0, sizeof(double) * 16);
  // (eq:bloch-matrices)
  for (int a = 0; a < bloch->per; a++)
    for (int b = 0; b < bloch->per; b++)
      M[bloch->family[a]][bloch->family[b]] += cos(phase(bloch, k, a, b, r)) * bloch->M[a][b];
}

/* K(k) of the families. */
static void stiffness(const ct_bloch *bloch, const double k[3], double K[SIZE][SIZE])
{
  memset(K, 0, sizeof(double) * SIZE * SIZE);
  // -- Every pair of nodes with the cosine of its phase (eq:bloch-matrices)
  for (int a = 0; a < bloch->per; a++)
    for (int b = 0; b < bloch->per; b++) {
      const int A = 3 * bloch->family[a], B = 3 * bloch->family[b];
      double r[3], half = sin(0.5 * phase(bloch, k, a, b, r)), cosine = 1.0 - 2.0 * half * half;
      // With one family the whole sum is 0 at k = 0: without it long waves keep their digits.
      double weight = bloch->families == 1 ? -2.0 * half * half : cosine;
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) K[A + i][B + j] += weight * bloch->K[3 * a + i][3 * b + j];
    }
}

/* Slope ∂ω²/∂k of one wave. */
static void add_slope(const ct_bloch *bloch, const double k[3], ct_bloch_wave *wave)
{
  for (int a = 0; a < bloch->per; a++)
    for (int b = 0; b < bloch->per; b++) {
      const double *u = &wave->shape[3 * bloch->family[a]], *v = &wave->shape[3 * bloch->family[b]];
      double r[3], minus_sine = -sin(phase(bloch, k, a, b, r)), product = 0.0;
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) product += u[i] * bloch->K[3 * a + i][3 * b + j] * v[j];
      product -= wave->omega2 * bloch->M[a][b] * ct_vector_dot(u, v);
      // (eq:group-velocity)
      for (int d = 0; d < 3; d++) wave->slope[d] += minus_sine * r[d] * product;
    }
}

/* Cholesky factor of the mass matrix, M = L Lᵀ. */
static void cholesky(int n, double M[4][4], double L[4][4])
{
  memset(L, 0, sizeof(double) * 16);
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) {
      double sum = M[i][j];
      for (int k = 0; k < j; k++) sum -= L[i][k] * L[j][k];
      L[i][j] = i == j ? sqrt(sum) : sum / L[j][j];
    }
}

/* Solve L y = x (or Lᵀ y = x) for each component of the displacements of the families. */
static void solve(int n, double L[4][4], int transposed, double x[SIZE])
{
  for (int step = 0; step < n; step++) {
    const int i = transposed ? n - 1 - step : step;
    for (int c = 0; c < 3; c++) {
      for (int j = transposed ? i + 1 : 0; j < (transposed ? n : i); j++)
        x[3 * i + c] -= (transposed ? L[j][i] : L[i][j]) * x[3 * j + c];
      x[3 * i + c] /= L[i][i];
    }
  }
}

/* Rotate the rows and columns p, q of A so that A_pq is 0, and the columns of V with them. */
static void rotate(int n, double A[SIZE][SIZE], double V[SIZE][SIZE], int p, int q)
{
  // (eq:jacobi-rotation)
  const double half = 0.5 * (A[q][q] - A[p][p]) / A[p][q];
  const double t = (half < 0.0 ? -1.0 : 1.0) / (fabs(half) + sqrt(1.0 + half * half));
  const double c = 1.0 / sqrt(1.0 + t * t), s = c * t;
  for (int k = 0; k < n; k++) {
    double a = A[k][p], b = A[k][q], v = V[k][p], w = V[k][q];
    A[k][p] = c * a - s * b, A[k][q] = s * a + c * b;
    V[k][p] = c * v - s * w, V[k][q] = s * v + c * w;
  }
  for (int k = 0; k < n; k++) {
    double a = A[p][k], b = A[q][k];
    A[p][k] = c * a - s * b, A[q][k] = s * a + c * b;
  }
  A[p][q] = A[q][p] = 0.0;
}

/* Jacobi's method: A becomes diagonal, and the columns of V its eigenvectors. */
static void diagonalize(int n, double A[SIZE][SIZE], double V[SIZE][SIZE])
{
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) V[i][j] = i == j;
  for (int sweep = 0, left = 1; left && sweep < 50; sweep++) {
    left = 0;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++)
        if (fabs(A[p][q]) > 1e-17 * (fabs(A[p][p]) + fabs(A[q][q])))
          left = 1, rotate(n, A, V, p, q);
  }
}

void ct_bloch_waves(const ct_bloch *bloch, const double k[3], ct_bloch_wave wave[SIZE])
{
  const int families = bloch->families, n = 3 * families;
  double A[SIZE][SIZE], V[SIZE][SIZE], M[4][4], L[4][4];
  stiffness(bloch, k, A);
  ct_bloch_mass(bloch, k, M);
  // -- Turn K φ = ω² M φ into L⁻¹ K L⁻ᵀ y = ω² y (eq:bloch-cholesky)
  cholesky(families, M, L);
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < n; i++) solve(families, L, 0, A[i]);
    for (int i = 0; i < n; i++)
      for (int j = 0; j < i; j++) {
        double held = A[i][j];
        A[i][j] = A[j][i], A[j][i] = held;
      }
  }
  diagonalize(n, A, V);
  for (int m = 0; m < n; m++) {
    int place = m;
    for (; place > 0 && wave[place - 1].omega2 > A[m][m]; place--) wave[place] = wave[place - 1];
    wave[place] = (ct_bloch_wave){.omega2 = A[m][m]};
    for (int i = 0; i < n; i++) wave[place].shape[i] = V[i][m];
  }
  for (int m = 0; m < n; m++) {
    wave[m].omega2 = fmax(wave[m].omega2, 0.0);
    solve(families, L, 1, wave[m].shape);
    add_slope(bloch, k, &wave[m]);
  }
}
