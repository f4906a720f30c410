// Steps a robot along a path of its motors and reads its sensors at a few instants only.

#ifndef BENCH_TRACK_H_
#define BENCH_TRACK_H_

#include <stdint.h>

#include <mujoco/mujoco.h>

// What to follow and where to read; all arrays are in C order.
typedef struct Course {
  int64_t nperiod, substeps;  // periods, and integration steps in each
  int64_t ndrive;
  const int64_t* servo_ctrl;     // (ndrive,) control of the position set point; that of the velocity follows it
  int64_t order;                 // of the polynomials, number of coefficients
  int64_t pitch;                 // numbers from one power to the next
  const mjtNum* path;            // (order, nperiod, ndrive), from the highest power of the time in a period
  mjtNum ahead;                  // by how much later the velocity set point is taken [s]
  const mjtNum* wrenches;        // (nperiod + 1, 6) on the load point, before the first and at the end of each period
  int64_t load_body;
  int64_t goes_on;               // 0: MuJoCo does the first step, so that nothing depends on what was called before
  int64_t nread;
  const int64_t* rows;           // (nread,) steps at which is read, growing
  mjtNum* records;               // (nread, nsensordata + 6 + 1 + nv): sensors, wrench and time of the instants at which
                                 // these steps begin, and the velocities with which they end
} Course;

// Returns the bytes that `track_prepare` needs.
int64_t track_size(void);

// Describes a model in `memory`. Returns 1 where it can be stepped without what nothing depends on, 0 where MuJoCo does
// every step.
int track_prepare(void* memory, const mjModel* m, int64_t load_body);

// Steps; returns how many steps MuJoCo did itself.
int64_t track_run(void* memory, const mjModel* m, mjData* d, const Course* course);

#endif  // BENCH_TRACK_H_
