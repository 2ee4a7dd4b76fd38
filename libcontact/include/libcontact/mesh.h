/* Meshes of bricks and their outer faces, materials, and masses of nodes.
 * Threads: several threads may read one mesh; one that changes its arrays must be alone with it. */
#ifndef LIBCONTACT_MESH_H
#define LIBCONTACT_MESH_H

#include <libcontact/base.h>
#include <libcontact/shape.h>

CT_BEGIN_DECLS

/** How stress follows from deformation; all three laws agree with Hooke's where strain and rotation
 * are small. */
typedef enum ct_law {
  /** small strain and small rotation, :eq:`hooke` */
  CT_LINEAR = 0,
  /** St. Venant-Kirchhoff, :eq:`st-venant-kirchhoff`: any rotation, moderate strain; it gives way
     under strong compression */
  CT_ST_VENANT_KIRCHHOFF = 1,
  /** compressible neo-Hookean, :eq:`neo-hookean`: any rotation, large strain */
  CT_NEO_HOOKEAN = 2
} ct_law;

/** An isotropic elastic material, in one consistent set of units. */
typedef struct ct_material {
  /** Young's modulus E [stress], > 0. */
  double young;
  /** Poisson's ratio ν [-], -1 < ν < 1/2. */
  double poisson;
  /** Density ρ [mass / volume] of the undeformed body, > 0. */
  double density;
  /** The law; 0 is small strain. */
  ct_law law;
} ct_material;

/** Speeds of the dilatation wave c₁ and of the transversal wave c₂ [length / time],
 * :eq:`wave-speeds`. */
CT_API void ct_material_speeds(const ct_material *material, double *c1, double *c2);

/**
 * Nodes and bricks of one body. The struct only points: the `ct_mesh_create_...` calls
 * allocate what they point to, and `ct_mesh_free` gives it back. A host may also fill one by hand.
 */
typedef struct ct_mesh {
  /** All elements are of one kind. */
  ct_brick_kind kind;
  /** Number of nodes. */
  int32_t node_count;
  /** Number of elements. */
  int32_t element_count;
  /** Reference coordinates X [length], shape (node_count, 3). */
  double *nodes;
  /** Node numbers of each element in VTK's order, shape (element_count, 8 or 20). */
  int32_t *elements;
  /** Most threads that check the mesh, lump its masses and prepare its elements; 0: one. They
   * change no bit. */
  int threads;
} ct_mesh;

/** Which way the numbers of a box run: layer by layer along one axis, and in a layer row by row. */
typedef enum ct_layers {
  /** Layers follow one another along z, and in them rows along y: element (i, j, k) has number i +
     cells[0] (j + cells[1] k). */
  CT_LAYERS_Z,
  /**
   * Layers follow one another along x. In them rows lie along that axis, y or z, that has more
   * cells (y, if both have as many).
   */
  CT_LAYERS_X,
  /** Layers follow one another along y; rows likewise lie along x or z. */
  CT_LAYERS_Y
} ct_layers;

/** A rectangular box of bricks. */
typedef struct ct_box {
  /** Corner with the smallest coordinates [length]. */
  double origin[3];
  /** Edge lengths [length], > 0. */
  double size[3];
  /** Elements along x, y, z, >= 1. */
  int32_t cells[3];
  /**
   * How they are numbered. No result depends on it, except where a point of contact is equally near
   * to several faces; but a wave that runs across the layers leaves whole layers asleep,
   * :doc:`/theory/savings`.
   */
  ct_layers layers;
} ct_box;

/**
 * The axes of a box in the order of its numbers: rows run along the first, and layers follow one
 * another along the last; 0, 1, 2 for x, y, z.
 */
CT_API void ct_box_axes(const ct_box *box, int axes[3]);

/**
 * Mesh a box with bricks, numbered as its `layers` say; ξ, η, ζ run along x, y, z. Node coordinates
 * are ((n - i) a + i b) / n between the ends a and b, so that mirrored boxes have exactly mirrored
 * nodes. Corner nodes come first, row by row; mid-side nodes of hex20 follow: those on edges along
 * the rows, then along the second, then along the third of `ct_box_axes`.
 */
CT_API ct_status ct_mesh_create_box(ct_brick_kind kind, const ct_box *box, ct_mesh **mesh,
                                    ct_error *error);

/** A ring (a tube) about an axis along z. */
typedef struct ct_ring {
  /** Its middle [length]. */
  double centre[3];
  /** Inner and outer radius [length], 0 < inner < outer. */
  double radius[2];
  /** Length along z [length], > 0. */
  double width;
  /** Elements along the radius, around (>= 3), along z. */
  int32_t cells[3];
} ct_ring;

/**
 * Mesh a ring with bricks: ξ runs outward, η around from x towards y, ζ along z; element (i, j, k)
 * has number i + cells[0] (j
 * + cells[1] k), and node numbers follow `ct_mesh_create_box` with cells[1] nodes around. Mid-side
 * nodes of hex20 lie on the circles. About its centre the ring mirrors exactly: along z and y for
 * every number of cells, along x for an even one, and x with y for one that 4 divides,
 * :eq:`mesh-ring`.
 */
CT_API ct_status ct_mesh_create_ring(ct_brick_kind kind, const ct_ring *ring, ct_mesh **mesh,
                                     ct_error *error);

/** Copy a mesh given by arrays and check it as `ct_mesh_check` does. */
CT_API ct_status ct_mesh_create_copy(const ct_mesh *source, ct_mesh **mesh, ct_error *error);

/** Free a mesh that one of the `ct_mesh_create_...` calls made; null is allowed. */
CT_API void ct_mesh_free(ct_mesh *mesh);

/**
 * Refuse node numbers out of range, coordinates that are not finite, and elements whose Jacobian
 * determinant is not positive at a Gauss point or at a node of the element (``CT_ERROR_GEOMETRY``;
 * `error` names the first such element, its Gauss point, or in the text its corner or mid-side
 * node, and its text counts all such elements). At a node the determinant may be zero where an edge
 * has collapsed or a mid-side node is at the quarter point, :eq:`jacobian-nodes`.
 */
CT_API ct_status ct_mesh_check(const ct_mesh *mesh, ct_error *error);

/**
 * Shortest edge between corner nodes of any element [length]: the h of the Courant number and of
 * the penalty. Edges that a wedge has collapsed to a point (below 1e-9 of the element's longest) do
 * not count. NaN for a null mesh.
 */
CT_API double ct_mesh_shortest_edge(const ct_mesh *mesh);

/**
 * Faces of a mesh, one that `ct_mesh_check` accepts, that belong to one element only and lie in the
 * plane ``x[axis] = value`` within 1e-9 of the mesh's size. `faces` gets (count, 4 or 8) node
 * numbers, counter-clockwise from outside, and `owners` (count) the elements; either may be null.
 * The return value is the count (call once with nulls to learn it), or a `ct_status` as a negative
 * number: ``-CT_ERROR_MEMORY``, or ``-CT_ERROR_ARGUMENT`` for no mesh, no elements, or a node
 * number out of range. It is 0 for an `axis` that is not 0, 1 or 2.
 */
CT_API int32_t ct_mesh_plane_faces(const ct_mesh *mesh, int axis, double value, int32_t *faces,
                                   int32_t *owners);

/** Nodes in the plane ``x[axis] = value`` within 1e-9 of the mesh's size, in ascending order;
 * returns their count. */
CT_API int32_t ct_mesh_plane_nodes(const ct_mesh *mesh, int axis, double value, int32_t *nodes);

/** All faces of the mesh that belong to one element only, as `ct_mesh_plane_faces` gives them, with
 * the same return values. */
CT_API int32_t ct_mesh_outer_faces(const ct_mesh *mesh, int32_t *faces, int32_t *owners);

/** How the consistent mass matrix is made diagonal. */
typedef enum ct_lumping {
  /** row sum for hex8, HRZ for hex20 */
  CT_LUMP_DEFAULT = 0,
  /** each row's sum goes to the diagonal, :eq:`row-sum` */
  CT_LUMP_ROW_SUM = 1,
  /** the diagonal, scaled to the element's mass, :eq:`hrz` */
  CT_LUMP_HRZ = 2
} ct_lumping;

/** Lumped mass of a whole mesh at its nodes, `mass` of shape (node_count) [mass]. */
CT_API ct_status ct_mass_lumped(const ct_mesh *mesh, double density, ct_lumping lumping,
                                double *mass, ct_error *error);

CT_END_DECLS

#endif
