/* Meshes of bricks and their outer faces, materials, and nodal masses.
 * Threads: several threads may read one mesh; while a thread changes its arrays, no other may use
 * it. */
#ifndef LIBCONTACT_MESH_H
#define LIBCONTACT_MESH_H

#include <libcontact/base.h>
#include <libcontact/shape.h>

CT_BEGIN_DECLS

/** Elastic laws. For small strain and rotation all agree with Hooke's law. */
typedef enum ct_law {
  /** small strain and small rotation, :eq:`hooke` */
  CT_LINEAR = 0,
  /** St. Venant-Kirchhoff, :eq:`st-venant-kirchhoff`: any rotation, moderate strain; unstable under
     strong compression */
  CT_ST_VENANT_KIRCHHOFF = 1,
  /** compressible neo-Hookean, :eq:`neo-hookean`: any rotation, large strain */
  CT_NEO_HOOKEAN = 2,
  /** Number of laws; it grows with later versions. */
  CT_LAW_COUNT
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

/** Write the speeds of the dilatational wave c₁ and of the shear wave c₂ [length / time],
 * :eq:`wave-speeds`. */
CT_API void ct_material_speeds(const ct_material *material, double *c1, double *c2);

/**
 * Nodes and bricks of one body. The `ct_mesh_create_...` calls allocate the arrays, and
 * `ct_mesh_free` frees them. A host may also fill the struct with pointers to its own arrays.
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
  /** Settings of the run, with whose threads the mesh is checked, its masses are lumped and its
   * elements are prepared; null: one thread. */
  const ct_run_settings *settings;
} ct_mesh;

/** Order of node and element numbers in a box: layer by layer along one axis, and row by row within
 * a layer. */
typedef enum ct_layers {
  /** Layers along z, rows along y: element (i, j, k) has number i + cells[0] (j + cells[1] k). */
  CT_LAYERS_Z,
  /**
   * Layers along x. Within a layer numbers run along y or z, whichever has more cells (y, if both
   * have as many).
   */
  CT_LAYERS_X,
  /** Layers along y. Within a layer numbers run along x or z, whichever has more cells (x, if both
     have as many). */
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
   * Order of the numbers. Results do not depend on it, except if a contact point is equally close
   * to several faces. If a wave travels across the layers, whole layers ahead of it can sleep,
   * :doc:`/theory/savings`.
   */
  ct_layers layers;
  /**
   * Along x, y, z the size of the last element over that of the first; the sizes between form a
   * geometric series, :eq:`mesh-grading`. 0 or 1: equal elements.
   */
  double grading[3];
  /**
   * Nonzero: `grading` along this axis is the size of the elements at both ends over that in the
   * middle, and the box is its own mirror image.
   */
  int symmetric[3];
} ct_box;

/**
 * Write the axes of a box in the order of its numbers, 0, 1, 2 for x, y, z: numbers run fastest
 * along the first axis, and layers follow one another along the last.
 */
CT_API void ct_box_axes(const ct_box *box, int axes[3]);

/**
 * Mesh a box with bricks, numbered as its `layers` say; ξ, η, ζ run along x, y, z. Equal elements
 * have nodes at ((n - i) a + i b) / n between the ends a and b, so that mirrored boxes have exactly
 * mirrored nodes. Corner nodes come first, row by row. Mid-side nodes of hex20 follow: those on
 * edges along the first, then the second, then the third axis of `ct_box_axes`.
 * ``CT_ERROR_ARGUMENT``: a size or a number of cells is not positive, a grading is outside 1e-6 ...
 * 1e6, or there are too many nodes.
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
 * has number i + cells[0] (j + cells[1] k), and nodes are numbered as in `ct_mesh_create_box` with
 * cells[1] nodes around. Mid-side nodes of hex20 lie on the circles. The coordinates are exactly
 * symmetric about the centre: along z and y for every number of cells around, along x for an even
 * number, and under exchange of x and y for a multiple of 4, :eq:`mesh-ring`.
 */
CT_API ct_status ct_mesh_create_ring(ct_brick_kind kind, const ct_ring *ring, ct_mesh **mesh,
                                     ct_error *error);

/** A solid cylinder (a disc) about an axis along z. */
typedef struct ct_cylinder {
  /** Its middle [length]. */
  double centre[3];
  /** Radius [length], > 0. */
  double radius;
  /** Length along z [length], > 0. */
  double width;
  /** Elements along the radius between core and surface, around (a multiple of 4), along z. */
  int32_t cells[3];
} ct_cylinder;

/**
 * Mesh a cylinder with bricks: a square core of cells[1] / 4 elements along x and y, and on each of
 * its four sides cells[0] layers up to the circle; ζ runs along z. Corners and mid-side nodes of
 * the surface lie on the circle, in nearly equal arcs, :eq:`mesh-spread`. Coordinates need only
 * products, quotients and roots, and are exactly symmetric about the centre: along x, y and z, and
 * under exchange of x and y. ``CT_ERROR_ARGUMENT``: a member is out of range.
 */
CT_API ct_status ct_mesh_create_cylinder(ct_brick_kind kind, const ct_cylinder *cylinder,
                                         ct_mesh **mesh, ct_error *error);

/** A ball, or the shell between two spheres. */
typedef struct ct_ball {
  /** Its centre [length]. */
  double centre[3];
  /** Inner and outer radius [length], 0 <= inner < outer; inner 0: a solid ball. */
  double radius[2];
  /** Elements along the radius (of a solid ball: between core and surface), and around a great
   * circle (a multiple of 4). */
  int32_t cells[2];
} ct_ball;

/**
 * Mesh a ball with bricks: a core of cells[1] / 4 elements along x, y and z, unless it is hollow,
 * and on each of its six sides cells[0] layers up to the sphere. Corners and mid-side nodes of the
 * surface lie on the sphere, :eq:`mesh-blocks`. Coordinates need only products, quotients and
 * roots, and are exactly symmetric about the centre: along x, y and z, and under every exchange of
 * axes. ``CT_ERROR_ARGUMENT``: a member is out of range.
 */
CT_API ct_status ct_mesh_create_ball(ct_brick_kind kind, const ct_ball *ball, ct_mesh **mesh,
                                     ct_error *error);

/** Copy a mesh given by arrays and check it as `ct_mesh_check` does. The copy has no `settings`. */
CT_API ct_status ct_mesh_create_copy(const ct_mesh *source, ct_mesh **mesh, ct_error *error);

/** Free a mesh that one of the `ct_mesh_create_...` calls made; null is allowed. */
CT_API void ct_mesh_free(ct_mesh *mesh);

/**
 * Check a mesh. ``CT_ERROR_ARGUMENT``: a node number out of range, two elements with the same
 * corners, or a face that three elements have; ``CT_INVALID``: a coordinate is not finite.
 * ``CT_ERROR_GEOMETRY``: the Jacobian determinant of an element is not positive at a Gauss point or
 * at a node. `error` then names the first such element and its Gauss point; its text names the
 * corner or mid-side node and gives the number of all such elements. At a node the determinant may
 * be zero if an edge has collapsed or a mid-side node is at the quarter point,
 * :eq:`jacobian-nodes`.
 */
CT_API ct_status ct_mesh_check(const ct_mesh *mesh, ct_error *error);

/**
 * Shortest edge between corner nodes of any element [length]: the h of the Courant number and of
 * the penalty. Edges that are collapsed to a point, as in a wedge (below 1e-9 of the element's
 * longest edge), do not count. NaN for a null mesh.
 */
CT_API double ct_mesh_shortest_edge(const ct_mesh *mesh);

/**
 * Find the faces of a valid mesh (see `ct_mesh_check`) that belong to one element only and lie in
 * the plane ``x[axis] = value`` within 1e-9 of the mesh's size. Writes node numbers,
 * counter-clockwise from outside, to `faces`, shape (count, 4 or 8), and the elements to `owners`,
 * shape (count); either may be null. Returns the count (call first with nulls to get it), or a
 * `ct_status` as a negative number: ``-CT_ERROR_MEMORY``, or ``-CT_ERROR_ARGUMENT`` for no mesh, no
 * elements, or a node number out of range. Returns 0 if `axis` is not 0, 1 or 2.
 */
CT_API int32_t ct_mesh_plane_faces(const ct_mesh *mesh, int axis, double value, int32_t *faces,
                                   int32_t *owners);

/** Write the nodes in the plane ``x[axis] = value`` within 1e-9 of the mesh's size to `nodes`, in
 * ascending order, and return their count; `nodes` may be null. */
CT_API int32_t ct_mesh_plane_nodes(const ct_mesh *mesh, int axis, double value, int32_t *nodes);

/** All faces of the mesh that belong to one element only; outputs and return values as in
 * `ct_mesh_plane_faces`. */
CT_API int32_t ct_mesh_outer_faces(const ct_mesh *mesh, int32_t *faces, int32_t *owners);

/**
 * Faces of a set that is given, as in most formats, by elements and their sides: `sides`, shape
 * (count, 2), has the number of an element and its side, 0 to 5 for ξ = -1, ξ = 1, η = -1, η = 1, ζ
 * = -1, ζ = 1. Writes node numbers, counter-clockwise from outside, to `faces`, shape (count, 4 or
 * 8). ``CT_ERROR_ARGUMENT``: a number out of range, a side that is inside the body, or one that is
 * listed twice (`error` names element and number in the list; `faces` is then undefined).
 */
CT_API ct_status ct_mesh_side_faces(const ct_mesh *mesh, int32_t count, const int32_t *sides,
                                    int32_t *faces, ct_error *error);

/** How the consistent mass matrix is made diagonal. */
typedef enum ct_lumping {
  /** row sum for hex8, HRZ for hex20 */
  CT_LUMP_DEFAULT = 0,
  /** row sum: the sum of each row on the diagonal, :eq:`row-sum` */
  CT_LUMP_ROW_SUM = 1,
  /** HRZ: the diagonal, scaled to the element's mass, :eq:`hrz` */
  CT_LUMP_HRZ = 2
} ct_lumping;

/** Write the lumped mass at the nodes of a mesh, `mass` of shape (node_count) [mass]. `density` is
 * in [mass / volume]. */
CT_API ct_status ct_mass_lumped(const ct_mesh *mesh, double density, ct_lumping lumping,
                                double *mass, ct_error *error);

CT_END_DECLS

#endif
