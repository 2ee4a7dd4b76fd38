#ifndef CT_SRC_EFFECT_SOLID_H
#define CT_SRC_EFFECT_SOLID_H

#include <libcontact/effect.h>

/* As ct_solid_create_effect, of meshes that have passed ct_mesh_check. */
ct_status ct_solid_create_checked(const ct_solid_def *def, ct_effect **effect, ct_error *error);

#endif
