// A step of MuJoCo's without what it computes for those who look, or for things that a free arm does not have.

#ifndef BENCH_LEAN_H_
#define BENCH_LEAN_H_

#include "forces.h"
#include "tree.h"

typedef struct Lean {
  bool is_known;     // whether the model can be stepped here
  bool has_damping;  // whether `damping` is known yet
  Tree tree;
  Forces forces;
  Point load;
  mjtNum damping[MAX_LINKS][MAX_LINKS];  // derivative of forces with respect to velocities, lower triangle
  mjtNum rotor_damping[MAX_LINKS];
} Lean;

// Describes a model; wrenches act at the centre of mass of `load_body`.
void lean_read(Lean* self, const mjModel* m, int load_body);

// Takes over what a step of MuJoCo's found for the derivatives, unless an actuator was at its limit.
void lean_learn(Lean* self, const mjModel* m, const mjData* d);

// Steps. `m` has the damping of Euler's integrator disabled. Returns false, with the state as it was, where the step is
// MuJoCo's to do: at a limit of a joint, a servo or an integral, and where numbers are not sound.
bool lean_step(Lean* self, const mjModel* m, mjData* d, const mjtNum* push);

#endif  // BENCH_LEAN_H_
