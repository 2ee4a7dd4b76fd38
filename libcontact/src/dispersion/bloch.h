#ifndef CT_SRC_DISPERSION_BLOCH_H
#define CT_SRC_DISPERSION_BLOCH_H

#include "../solid/element.h"

#include <libcontact/dispersion.h>

enum { CT_CELL_SIZE = 12 };

/* One brick of an infinite mesh of equal ones. Its nodes form families: those of one family are
 * copies of each other, shifted by edges of the brick. */
typedef struct ct_bloch {
  int per, families;
  int family[20];
  double x[20][3];
  double mass;
  double K[CT_ELEMENT_SIZE][CT_ELEMENT_SIZE];
  double M[20][20];
} ct_bloch;

/* The waves of one wave vector: ω², its slope ∂ω²/∂k, and the shape φ with φ·M(k)φ = 1. */
typedef struct ct_bloch_wave {
  double omega2, slope[3], shape[CT_CELL_SIZE];
} ct_bloch_wave;

/* Check the brick and integrate its matrices (eq:stiffness, eq:mass-consistent, eq:hrz). */
ct_status ct_bloch_init(const ct_dispersion_def *def, ct_bloch *bloch, ct_error *error);

/* Mass matrix of the families at a wave vector, M(k) (eq:bloch-matrices). */
void ct_bloch_mass(const ct_bloch *bloch, const double k[3], double M[4][4]);

/* All waves of a wave vector, 3 for each family, ascending in ω² (eq:bloch-problem). */
void ct_bloch_waves(const ct_bloch *bloch, const double k[3], ct_bloch_wave wave[CT_CELL_SIZE]);

#endif
