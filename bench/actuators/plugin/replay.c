// The robot along a prescribed motion of its motors: what bench/simulate/prescribed.py asks for, in one call.
//
// At every instant the links, and any passive hinges, are put where gravity, inertia, counterbalance, friction, load and
// elastic elements balance; friction elements and gas then take over the state of that instant. The readable NumPy
// version, instant by instant, is bench/simulate/reference_replay.py; the two agree to 1e-10.

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include <mujoco/mujoco.h>

#include "instance.h"
#include "undriven.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

// Numbers of the search, from the Python side, which says where they come from.
typedef struct Search {
  double tolerance;        // of the torques on the links, relative
  double step_resolution;  // [rad]
  int32_t most_iterations;
  int32_t patience;  // iterations after which steps are kept within brackets
} Search;

// Addresses and stiffnesses of one model; n drives, u unknowns (links first, then passive hinges).
typedef struct Arm {
  int32_t n;
  int32_t u;
  int32_t nsite;
  int32_t load_body;
  int32_t counterbalance;         // actuator, -1: none
  int32_t counterbalance_tendon;  // -1: none
  const int32_t* theta;           // (n) qpos
  const int32_t* theta_dof;       // (n)
  const int32_t* q;               // (n) qpos
  const int32_t* q_dof;           // (n)
  const int32_t* servo;           // (n) actuators
  const int32_t* motor_friction;  // (n) actuators
  const int32_t* link_friction;   // (n) actuators
  const int32_t* site;            // (nsite)
  const int32_t* dof;             // (u) of the unknowns
  const int32_t* position;        // (u) qpos of the unknowns
  const double* sliding;          // (u) stiffness while friction slides [Nm/rad]
  const double* sticking;         // (u) while it holds
  const double* softest;          // (u) least and largest slope of a step
  const double* stiffest;         // (u)
} Arm;

// Motions one after the other, T instants in all.
typedef struct Course {
  int32_t length;
  const uint8_t* begins;       // (T) a motion begins: nothing is remembered from before, but `gas_rise`
  const uint8_t* read;         // (T) it is written to `Seen`
  const double* time;          // (T) [s]
  const double* q;             // (T, n) motor angles
  const double* velocity;      // (T, n)
  const double* acceleration;  // (T, n)
  const double* link_velocity;      // (T, n)
  const double* link_acceleration;  // (T, n)
  const double* wrench;        // (T, 6) on the load point
  const double* guess;         // (T, 2, u) positions and slopes, or NULL
  const double* gas_rise;      // (T) T / T0 - 1 of the gas where a motion begins, or NULL: none
} Course;

// What was found; K instants are read.
typedef struct Seen {
  double* found;     // (T, 2, u) positions and slopes
  double* load;      // (T, n) what inertia, gravity, the push and the counterbalance ask of the elastic elements
  double* theta;     // (K, n)
  double* torque;    // (K, n) of the motors
  double* motor;     // (K, n) friction on the rotor
  double* link;      // (K, n) friction on the link
  double* points;    // (K, nsite, 3)
  double* cylinder;  // (K, 2) pull and length
  double left;       // [Nm] where no balance was found
} Seen;

// Work space of a search, u numbers each.
typedef struct Work {
  mjModel model;  // a shallow copy, for the length of a step and the flags are changed
  mjData* data;
  const Arm* arm;
  const Search* search;
  const double* push;  // (6), NULL: none
  bool accelerates;
  Undriven* lean;  // NULL: the model has parts that are MuJoCo's to evaluate
  double* outside;  // (nv) torques of inertia, gravity and the push
  double* servos;   // (na) what integrals of servos stood at
  double* residual;
  double* before;
  double* step;
  double* slope;
  double* unknown;
  double* low;
  double* high;
} Work;

static bool any(const double* values, int n) {
  for (int i = 0; i < n; i++) {
    if (values[i] != 0) {
      return true;
    }
  }
  return false;
}

// Has MuJoCo do what `undriven_update` does.
static void evaluate(Work* w) {
  const mjModel* m = &w->model;
  mjData* d = w->data;
  const int body = w->arm->load_body;
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_tendon(m, d);
  mj_transmission(m, d);
  mj_fwdVelocity(m, d);
  mj_fwdActuation(m, d);
  if (w->accelerates) {
    mj_rne(m, d, 1, w->outside);  // without armature, which only the rotors have
    mju_scl(w->outside, w->outside, -1, m->nv);
  } else {
    mju_scl(w->outside, d->qfrc_bias, -1, m->nv);
  }
  if (w->push) {
    mj_applyFT(m, d, w->push, w->push + 3, d->xipos + 3 * body, body, w->outside);
  }
}

// Writes the torque left on every unknown and returns the square of what may be left.
static double balance_residual(Work* w) {
  const mjModel* m = &w->model;
  mjData* d = w->data;
  const Arm* arm = w->arm;
  for (int k = 0; k < arm->u; k++) {
    d->qpos[arm->position[k]] = w->unknown[k];
  }
  if (w->lean) {
    undriven_update(w->lean, m, d, w->push, w->outside);
  } else {
    evaluate(w);
  }
  double sprung = 0;
  for (int k = 0; k < arm->u; k++) {
    const int dof = arm->dof[k];
    const double passive = d->qfrc_passive[dof];
    sprung += passive * passive;
    w->residual[k] = passive + d->qfrc_actuator[dof] + w->outside[dof];
  }
  return w->search->tolerance * w->search->tolerance * (1.0 + sprung);
}

static double square(const double* values, int n) {
  double sum = 0;
  for (int i = 0; i < n; i++) {
    sum += values[i] * values[i];
  }
  return sum;
}

static int largest(const double* values, int n) {
  int found = 0;
  for (int i = 1; i < n; i++) {
    found = fabs(values[i]) > fabs(values[found]) ? i : found;
  }
  return found;
}

// Keeps a step between the places where the torque left was positive and where it was negative. Secants can run in
// circles where friction slips on both sides, and creep where play meets a flank; then the unknown that misses most goes
// to the middle. A bracket is opened again where no balance can lie in it any more, for the other unknowns add a little.
static void keep_in_bracket(Work* w, bool halves) {
  const int u = w->arm->u;
  const int worst = largest(w->residual, u);
  for (int k = 0; k < u; k++) {
    const double at = w->unknown[k];
    const double near = w->residual[k] / w->arm->stiffest[k];  // no balance is nearer than that
    if (near > 0) {
      w->low[k] = at;
    }
    if (near < 0) {
      w->high[k] = at;
    }
    if (w->high[k] - w->low[k] < fabs(near)) {
      if (near < 0) {
        w->low[k] = -INFINITY;
      } else if (near > 0) {
        w->high[k] = INFINITY;
      }
    }
    const double aim = at + w->step[k];
    if (isfinite(w->low[k]) && isfinite(w->high[k])) {
      if ((halves && k == worst) || aim <= w->low[k] || aim >= w->high[k]) {
        w->step[k] = (w->low[k] + w->high[k]) / 2 - at;
        continue;
      }
    }
    w->step[k] = aim - at;
  }
}

// Puts the unknowns where they balance; w->unknown and w->slope hold the first guess, and then what was found.
static bool balance(Work* w) {
  const Arm* arm = w->arm;
  const Search* search = w->search;
  const int u = arm->u;
  double limit = balance_residual(w);
  bool has_bracket = false;
  double before_last = INFINITY;  // the torque left when brackets were last looked at
  for (int iteration = 0; iteration < search->most_iterations; iteration++) {
    if (square(w->residual, u) < limit) {
      return true;
    }
    if (iteration) {
      for (int k = 0; k < u; k++) {
        if (fabs(w->step[k]) > search->step_resolution) {
          const double secant = (w->before[k] - w->residual[k]) / w->step[k];
          double least = arm->softest[k];
          if (fabs(w->residual[k]) > fabs(w->before[k]) / 2) {
            // where nothing is transmitted, steps double until they meet the other flank
            least = fmin(least, fabs(w->residual[k] / w->step[k]) / 2);
          }
          w->slope[k] = fmin(fmax(secant, least), arm->stiffest[k]);
        }
      }
    }
    for (int k = 0; k < u; k++) {
      w->step[k] = w->residual[k] / w->slope[k];
    }
    if (iteration >= search->patience) {
      if (!has_bracket) {
        for (int k = 0; k < u; k++) {
          w->low[k] = -INFINITY;
          w->high[k] = INFINITY;
        }
        has_bracket = true;
      }
      bool halves = false;
      if (iteration % 2) {
        const double most = fabs(w->residual[largest(w->residual, u)]);
        halves = most > before_last / 2;
        before_last = most;
      }
      keep_in_bracket(w, halves);
    }
    for (int k = 0; k < u; k++) {
      w->unknown[k] += w->step[k];
      w->before[k] = w->residual[k];
    }
    limit = balance_residual(w);
  }
  return false;
}

// Lets the plugins take over the state of this instant: an integration step in which nothing moves.
static void remember(Work* w) {
  mjData* d = w->data;
  mjModel* m = &w->model;
  const double time = d->time;
  mju_zero(d->qvel, m->nv);
  mju_zero(d->qacc, m->nv);
  if (w->lean && !m->nplastic) {
    forces_remember(&w->lean->forces, m, d);
    return;
  }
  mju_copy(w->servos, d->act, m->na);
  const int flags = m->opt.disableflags;
  m->opt.disableflags = flags | mjDSBL_EULERDAMP;  // a drag that was learned may fall with speed; nothing moves
  mj_Euler(m, d);
  m->opt.disableflags = flags;
  d->time = time;
  mju_copy(d->act, w->servos, m->na);
}

// Writes what the elastic elements have to carry, but for friction and what else acts on a joint.
static void write_load(const Work* w, double* load) {
  const mjData* d = w->data;
  const Arm* arm = w->arm;
  for (int j = 0; j < arm->n; j++) {
    load[j] = -w->outside[arm->theta_dof[j]];
  }
  if (arm->counterbalance < 0) {
    return;
  }
  const int out = w->model.actuator_outadr[arm->counterbalance];
  const int first = d->moment_rowadr[out], end = first + d->moment_rownnz[out];
  for (int i = first; i < end; i++) {
    for (int j = 0; j < arm->n; j++) {
      if (d->moment_colind[i] == arm->theta_dof[j]) {
        load[j] -= d->actuator_moment[i] * d->actuator_force[out];
      }
    }
  }
}

static void write_instant(const Work* w, Seen* seen, int row, const double* acceleration) {
  const mjModel* m = &w->model;
  const mjData* d = w->data;
  const Arm* arm = w->arm;
  const int n = arm->n;
  for (int j = 0; j < n; j++) {
    const int dof = arm->q_dof[j];
    // what the motors put out: inertia, viscous and Coulomb friction, and the element
    const double others = d->qfrc_actuator[dof] - d->actuator_force[arm->servo[j]];
    seen->theta[row * n + j] = d->qpos[arm->theta[j]];
    seen->torque[row * n + j] = m->dof_armature[dof] * acceleration[j] - d->qfrc_passive[dof] - others;
    seen->motor[row * n + j] = d->actuator_force[arm->motor_friction[j]];
    seen->link[row * n + j] = d->actuator_force[arm->link_friction[j]];
  }
  for (int s = 0; s < arm->nsite; s++) {
    double* point = seen->points + 3 * ((size_t)row * arm->nsite + s);
    if (w->lean) {
      undriven_site(w->lean, s, point);
    } else {
      mju_copy3(point, d->site_xpos + 3 * arm->site[s]);
    }
  }
  if (arm->counterbalance >= 0) {
    seen->cylinder[2 * row] = -d->actuator_force[arm->counterbalance];
    seen->cylinder[2 * row + 1] = d->ten_length[arm->counterbalance_tendon];
  }
}

// Puts everything back to where nothing is remembered, with gas that is as much warmer than its surroundings as given.
static void begin(Work* w, double rise) {
  const mjModel* m = &w->model;
  mjData* d = w->data;
  mj_resetData(m, d);
  const int cylinder = w->arm->counterbalance;
  if (rise != 0 && cylinder >= 0) {
    const int instance = m->actuator_plugin[cylinder];
    int count = 0, before = 0;
    for (int i = 0; i < m->nactuator; i++) {
      count += m->actuator_plugin[i] == instance;
      before += m->actuator_plugin[i] == instance && i < cylinder;
    }
    const int nstate = m->plugin_statenum[instance] / count;
    d->plugin_state[m->plugin_stateadr[instance] + before * nstate + FRICTION_STATES] = rise;
  }
  if (w->lean) {
    undriven_begin(m, d);
  }
}

// Follows the motions. Returns the index of the first instant without a balance, whose largest torque is in `seen`, or -1.
EXPORT int bench_replay(const mjModel* model, mjData* data, const Arm* arm, const Search* search, const Course* course,
                        Seen* seen) {
  const int n = arm->n, u = arm->u, nv = model->nv;
  double* numbers = mju_malloc((size_t)(nv + model->na + 7 * u) * sizeof(double));
  Work w = {.model = *model, .data = data, .arm = arm, .search = search};
  double** parts[] = {&w.residual, &w.before, &w.step, &w.slope, &w.unknown, &w.low, &w.high};
  w.outside = numbers;
  w.servos = numbers + nv;
  for (int i = 0; i < 7; i++) {
    *parts[i] = w.servos + model->na + i * u;
  }
  Undriven lean;
  undriven_read(&lean, model, arm->load_body, arm->servo, n, arm->site, arm->nsite);
  w.lean = lean.is_known ? &lean : NULL;
  const double own_step = model->opt.timestep;
  int row = 0, failed = -1;
  for (int i = 0; i < course->length && failed < 0; i++) {
    const double* q = course->q + i * n;
    const double* velocity = course->velocity + i * n;
    const double* acceleration = course->acceleration + i * n;
    const double* link_velocity = course->link_velocity + i * n;
    const double* link_acceleration = course->link_acceleration + i * n;
    const double* push = course->wrench + 6 * i;
    double* found = seen->found + 2 * (size_t)i * u;
    const double since = i ? course->time[i] - course->time[i - 1] : 0;  // [s]
    if (course->begins[i]) {
      begin(&w, course->gas_rise ? course->gas_rise[i] : 0);
    }
    // gas relaxes over what the plugin takes for one step
    w.model.opt.timestep = fmax(since, own_step);
    for (int j = 0; j < n; j++) {
      data->qpos[arm->q[j]] = q[j];
      data->qvel[arm->q_dof[j]] = velocity[j];
      data->qvel[arm->theta_dof[j]] = link_velocity[j];
      data->qacc[arm->q_dof[j]] = acceleration[j];
      data->qacc[arm->theta_dof[j]] = link_acceleration[j];
    }
    if (course->guess) {
      const double* guess = course->guess + 2 * (size_t)i * u;
      for (int k = 0; k < u; k++) {
        // what the guess missed an instant ago it is likely to miss again
        w.unknown[k] = guess[k] + (course->begins[i] ? 0 : w.unknown[k] - guess[k - 2 * u]);
      }
      mju_copy(w.slope, guess + u, u);
    } else {
      if (course->begins[i]) {
        mju_zero(w.unknown, u);
        mju_copy(w.unknown, q, n);
      } else {
        for (int j = 0; j < n; j++) {
          w.unknown[j] += q[j] - q[j - n];
        }
      }
      mju_copy(w.slope, any(velocity, n) ? arm->sliding : arm->sticking, u);
    }
    w.accelerates = any(link_acceleration, n);
    w.push = any(push, 6) ? push : NULL;
    if (!balance(&w)) {
      failed = i;
      seen->left = 0;
      for (int k = 0; k < u; k++) {
        seen->left = fmax(seen->left, fabs(w.residual[k]));
      }
      break;
    }
    mju_copy(found, w.unknown, u);
    mju_copy(found + u, w.slope, u);
    write_load(&w, seen->load + (size_t)i * n);
    if (course->read[i]) {
      write_instant(&w, seen, row++, acceleration);
    }
    remember(&w);
  }
  mju_free(numbers);
  return failed;
}
