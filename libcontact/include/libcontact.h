/* libcontact: explicit finite-element contact-impact. One include for everything that needs libc
 * and libm only; output.h (HDF5) and series.h (GSL) belong to the add-on libraries. */
#ifndef LIBCONTACT_H
#define LIBCONTACT_H

#include <libcontact/base.h>
#include <libcontact/shape.h>
#include <libcontact/exact.h>
#include <libcontact/projection.h>
#include <libcontact/ray.h>
#include <libcontact/batch.h>
#include <libcontact/mesh.h>
#include <libcontact/search.h>
#include <libcontact/solid.h>
#include <libcontact/constraint.h>
#include <libcontact/problem.h>
#include <libcontact/step.h>
#include <libcontact/piece.h>
#include <libcontact/ledger.h>
#include <libcontact/observe.h>
#include <libcontact/effect.h>
#include <libcontact/dispersion.h>
#include <libcontact/contact.h>
#include <libcontact/contact_result.h>
#include <libcontact/contact_effect.h>
#include <libcontact/scene.h>

#endif
