// What the three actuators share. A plugin instance has one element per actuator that uses it: parameters that are read
// once, a force that is a pure function of the state, and a state that moves on once per step.

#ifndef BENCH_INSTANCE_H_
#define BENCH_INSTANCE_H_

#include "attributes.h"

// Layout of the state of an element. All zeros is a fresh one: unstressed wherever the first step finds it.
enum {
  HELD = 0,      // friction force at the start of the last step [N] or [Nm]
  POSITION = 1,  // actuator length at the start of the last step [m] or [rad]
  ANCHORED = 2,  // 0: POSITION is unknown yet, HELD counts for the present position
  FRICTION_STATES = 3,
};

// Head of the parameters of every law.
typedef struct Element {
  int actuator;
  int output;  // index of length, velocity and force in mjData
} Element;

// One actuator law.
typedef struct Law {
  const char* name;
  const Number* numbers;
  int nnumber;
  const char* const* texts;  // names of the attributes that are not numbers
  int ntext;
  size_t size;  // of the parameters of an element
  int nstate;   // of an element
  // Checks and reads what the table of numbers cannot say.
  void (*read)(Element* element, Reader* reader);
  // Frees what `read` allocated; may be NULL.
  void (*clear)(Element* element);
  // Returns the actuator force and writes the state that a step from here leaves behind; `next` may be `state`.
  mjtNum (*force)(Element* element, const mjModel* m, const mjData* d, const mjtNum* state, mjtNum* next);
  // Draws the element; may be NULL.
  void (*draw)(const Element* element, const mjModel* m, const mjData* d, const mjvOption* opt, mjvScene* scn);
} Law;

extern const Law friction_law;
extern const Law gas_spring_law;
extern const Law torque_table_law;

// Registers a law as an actuator plugin; `init` and `nstate` are its own because MuJoCo does not pass the plugin.
void register_law(const Law* law, int (*init)(const mjModel*, mjData*, int), int (*nstate)(const mjModel*, int));

// Reads the parameters of an instance. Returns 0, or -1 after a warning.
int init_instance(const Law* law, const mjModel* m, mjData* d, int instance);

// Returns the number of states of an instance.
int count_states(const Law* law, const mjModel* m, int instance);

// Elasto-plastic return map: an elastic trial, clamped to the level against the motion.
static inline mjtNum return_map(mjtNum force, mjtNum dx, mjtNum sigma, mjtNum level_minus, mjtNum level_plus) {
  mjtNum trial = force - sigma * dx;
  return trial < -level_plus ? -level_plus : trial > level_minus ? level_minus : trial;
}

// Friction force at position x, and the friction part of the next state.
static inline mjtNum hold(const mjtNum* state, mjtNum x, mjtNum sigma, mjtNum level_minus, mjtNum level_plus,
                          mjtNum* next) {
  mjtNum dx = state[ANCHORED] ? x - state[POSITION] : 0;
  next[HELD] = return_map(state[HELD], dx, sigma, level_minus, level_plus);
  next[POSITION] = x;
  next[ANCHORED] = 1;
  return next[HELD];
}

#endif  // BENCH_INSTANCE_H_
