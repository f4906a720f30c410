#include "track.h"

#include <string.h>

#include "lean.h"

#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif

EXPORTED int64_t track_size(void) {
  return (int64_t)sizeof(Lean);
}

EXPORTED int track_prepare(void* memory, const mjModel* m, int64_t load_body) {
  Lean* lean = memory;
  lean_read(lean, m, (int)load_body);
  return lean->is_known;
}

static void set_inputs(mjData* d, const Course* course, int64_t i, mjtNum h, mjtNum* push) {
  int64_t period = i / course->substeps, k = i % course->substeps, n = course->ndrive;
  mjtNum s = h * (mjtNum)k, later = s + course->ahead;
  for (int64_t j = 0; j < n; j++) {
    const mjtNum* c = course->path + period * n + j;
    mjtNum position = c[0], velocity = 0;
    for (int64_t p = 1; p < course->order; p++) {
      velocity = velocity * later + (mjtNum)(course->order - p) * c[(p - 1) * course->pitch];
      position = position * s + c[p * course->pitch];
    }
    d->ctrl[course->servo_ctrl[j]] = position;
    d->ctrl[course->servo_ctrl[j] + 1] = velocity;
  }
  const mjtNum* before = course->wrenches + 6 * period;
  mjtNum blend = (mjtNum)k / (mjtNum)course->substeps;
  for (int j = 0; j < 6; j++) {
    push[j] = before[j] + blend * (before[6 + j] - before[j]);
  }
}

// Whether lengths and moments were computed since `d` was made or reset: a lean step goes on with those that never change.
static bool has_moments(const mjModel* m, const mjData* d) {
  for (int i = 0; i < m->nout; i++) {
    if (!d->moment_rownnz[i]) {
      return false;
    }
  }
  return true;
}

EXPORTED int64_t track_run(void* memory, const mjModel* m, mjData* d, const Course* course) {
  Lean* lean = memory;
  mjModel blind = *m, plain = *m;  // the same arrays under other options
  blind.opt.disableflags |= mjDSBL_SENSOR;
  plain.opt.disableflags |= mjDSBL_EULERDAMP;
  mju_zero(d->ctrl, (int)m->nu);
  mju_zero(d->xfrc_applied, (int)(6 * m->nbody));
  mju_zero(d->qfrc_applied, (int)m->nv);
  mju_zero(d->qacc_warmstart, (int)m->nv);
  mjtNum* push = d->xfrc_applied + 6 * course->load_body;
  mjtNum* record = course->records;
  int64_t steps = course->nperiod * course->substeps, read = 0, whole = 0;
  bool begins_whole = !course->goes_on || !has_moments(m, d);
  for (int64_t i = 0; i < steps; i++) {
    set_inputs(d, course, i, m->opt.timestep, push);
    bool is_read = read < course->nread && course->rows[read] == i;
    mjtNum time = d->time;
    // The last step leaves all that belongs to its instant.
    bool is_whole = is_read || i == steps - 1 || (begins_whole && i == 0);
    if (is_whole || !lean_step(lean, &plain, d, push)) {
      mj_step(is_read ? m : &blind, d);
      lean_learn(lean, m, d);
      whole++;
    }
    if (is_read) {
      memcpy(record, d->sensordata, (size_t)m->nsensordata * sizeof(mjtNum));
      record += m->nsensordata;
      memcpy(record, push, 6 * sizeof(mjtNum));
      record[6] = time;
      memcpy(record + 7, d->qvel, (size_t)m->nv * sizeof(mjtNum));
      record += 7 + m->nv;
      read++;
    }
  }
  return whole;
}
