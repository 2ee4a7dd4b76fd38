/* libcontact: explicit finite-element contact-impact. One include for everything that needs libc
 * and libm only. */
#ifndef CONTACT_H
#define CONTACT_H

#include <contact/status.h>
#include <contact/sum.h>
#include <contact/quadrature.h>
#include <contact/segment.h>
#include <contact/brick.h>
#include <contact/projection.h>
#include <contact/batch.h>
#include <contact/search.h>
#include <contact/material.h>
#include <contact/mesh.h>
#include <contact/mass.h>
#include <contact/enforcement.h>
#include <contact/effect.h>
#include <contact/solid.h>
#include <contact/contact.h>
#include <contact/support.h>
#include <contact/integrator.h>
#include <contact/step.h>
#include <contact/viscosity.h>
#include <contact/energy.h>
#include <contact/watch.h>
#include <contact/history.h>
#include <contact/gravity.h>
#include <contact/load.h>
#include <contact/damping.h>
#include <contact/motion.h>
#include <contact/absorb.h>
#include <contact/obstacle.h>
#include <contact/friction.h>
#include <contact/scene.h>
#include <contact/exact.h>

#endif
