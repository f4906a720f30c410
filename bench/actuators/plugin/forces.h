// Forces of tendons, joints and actuators on the degrees of freedom, for models in which they are simple enough.

#ifndef BENCH_FORCES_H_
#define BENCH_FORCES_H_

#include <mujoco/mjplugin.h>

#include "tree.h"

enum { MAX_STRAIGHT = 4, MAX_SERVOS = 32, MAX_PLUGINS = 32 };

// A spatial tendon that runs straight between two sites.
typedef struct Straight {
  int tendon;
  Point from, to;
} Straight;

// An actuator of MuJoCo's own: bias + kp * position + kv * velocity + ki * integral, or bias + gain * control.
typedef struct Servo {
  int actuator, output;
  int control, integral;  // addresses; control -1: it has no input, integral -1: none
  bool is_pid;
  mjtNum most;  // bound of the integral
} Servo;

typedef struct Forces {
  int nstraight, nservo, nplugin;
  bool is_plain;    // springs are linear but for dead bands, and none yields
  bool has_limits;  // joints cut off what actuators do on them
  Straight straight[MAX_STRAIGHT];
  Servo servo[MAX_SERVOS];
  int instance[MAX_PLUGINS];
  void (*compute[MAX_PLUGINS])(const mjModel* m, mjData* d, int instance, int capability_bit);
  void (*advance[MAX_PLUGINS])(const mjModel* m, mjData* d, int instance);
} Forces;

// Describes a model, but for the ends of its straight tendons. Returns false where something is not simple.
bool forces_read(Forces* self, const mjModel* m);

// Writes the sites between which straight tendons run, two each, and takes over where these are.
void forces_ends(const Forces* self, const mjModel* m, int* sites);
void forces_join(Forces* self, const Point* ends);

// Computes lengths, velocities, and forces of springs, dampers and actuators; force has size nv. Returns false where an
// input, an integral, a force or what acts on a joint reaches its bound; `d` then is MuJoCo's to compute again.
bool forces_update(const Forces* self, const Tree* tree, const mjModel* m, mjData* d, mjtNum* force);

// Writes the same to `qfrc_passive` and `qfrc_actuator`, without the servos, which count as switched off.
void forces_undriven(const Forces* self, const Tree* tree, const mjModel* m, mjData* d);

// Lets the plugins take over the state that `forces_update` or `forces_undriven` found.
void forces_remember(const Forces* self, const mjModel* m, mjData* d);

// Integrates one step with the accelerations in `d`, velocity first.
void forces_advance(const Forces* self, const mjModel* m, mjData* d);

#endif  // BENCH_FORCES_H_
