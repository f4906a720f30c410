// Torques on an arm whose servos are off: what a search for its balance asks of the model, without what MuJoCo computes
// for others.

#ifndef BENCH_UNDRIVEN_H_
#define BENCH_UNDRIVEN_H_

#include "forces.h"
#include "tree.h"

enum { MAX_SITES = 32 };

typedef struct Undriven {
  bool is_known;  // whether the model can be evaluated here
  Tree tree;
  Forces forces;
  Point load;
  Point site[MAX_SITES];
} Undriven;

// Describes a model. Wrenches act at the centre of mass of `load_body`; every actuator that is no plugin is to be one of
// the `n` servos.
void undriven_read(Undriven* self, const mjModel* m, int load_body, const int32_t* servo, int n, const int32_t* site,
                   int nsite);

// Computes once with MuJoCo what never changes in `d` after a reset: constant Jacobians, and where their numbers are.
void undriven_begin(const mjModel* m, mjData* d);

// Takes over positions, velocities and accelerations: writes `qfrc_passive`, `qfrc_actuator` without servos,
// `actuator_force`, lengths, and to `outside`, shape nv, the torques of inertia, gravity and `push`, unless that is NULL.
void undriven_update(Undriven* self, const mjModel* m, mjData* d, const mjtNum* push, mjtNum* outside);

// World coordinates of a site.
void undriven_site(const Undriven* self, int i, mjtNum result[3]);

#endif  // BENCH_UNDRIVEN_H_
