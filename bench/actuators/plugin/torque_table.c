// bench.torque_table: a torque over angle and direction. The mean of both directions is conservative; half of their
// difference is a friction level, held like that of bench.friction.

#include "instance.h"

typedef struct TorqueTable {
  Element element;
  double angle_min;
  double angle_max;
  double presliding_stiffness;
  int count;
  double per_angle;  // grid intervals per unit of angle
  double* mean;      // torques of both directions: mean ...
  double* level;     // ... and half of their difference
} TorqueTable;

static const Number kNumbers[] = {
    {"angle_min", offsetof(TorqueTable, angle_min), REQUIRED, ANY},
    {"angle_max", offsetof(TorqueTable, angle_max), REQUIRED, ANY},
    {"presliding_stiffness", offsetof(TorqueTable, presliding_stiffness), UNSET, POSITIVE},
};

static const char* const kTexts[] = {"forward", "backward"};

// Turns the torques of both directions, which it takes over, into mean and level.
static void split(TorqueTable* self, Reader* reader, double* forward, double* backward) {
  bool friction = false;
  self->mean = forward;
  self->level = backward;
  for (int i = 0; i < self->count; i++) {
    double mean = (forward[i] + backward[i]) / 2;
    double level = (backward[i] - forward[i]) / 2;
    if (level < 0) {
      attribute_fault(reader, "backward", "must nowhere be below forward: such friction would drive the motion");
    }
    friction |= level > 0;
    if (!isfinite(mean) || !isfinite(level)) {
      attribute_fault(reader, "forward", "must have a finite sum and a finite difference with backward");
    }
    self->mean[i] = mean;
    self->level[i] = level;
  }
  if (friction) {
    need(reader, "presliding_stiffness", "is needed with torques that differ between forward and backward");
  }
}

static void read(Element* element, Reader* reader) {
  TorqueTable* self = (TorqueTable*)element;
  if (reader->count > 1) {
    fault(reader, "shares its plugin instance with another actuator; give each table its own");
    return;
  }
  int nbackward;
  double* forward = read_list(reader, "forward", &self->count);
  double* backward = read_list(reader, "backward", &nbackward);
  if (reader->ok && self->angle_max <= self->angle_min) {
    attribute_fault(reader, "angle_max", "must be above angle_min");
  }
  if (reader->ok && self->count < 2) {
    attribute_fault(reader, "forward", "must have two numbers or more");
  }
  if (reader->ok && nbackward != self->count) {
    attribute_fault(reader, "backward", "must have as many numbers as forward");
  }
  if (!reader->ok) {
    mju_free(forward);
    mju_free(backward);
    return;
  }
  double range = self->angle_max - self->angle_min;
  self->per_angle = (self->count - 1) / range;
  if (!isfinite(range) || !isfinite(self->per_angle)) {
    attribute_fault(reader, "angle_max", "must be so far above angle_min that both are told apart, and not farther");
  }
  split(self, reader, forward, backward);
}

static void clear(Element* element) {
  TorqueTable* self = (TorqueTable*)element;
  mju_free(self->mean);
  mju_free(self->level);
}

static mjtNum force(Element* element, const mjModel* m, const mjData* d, const mjtNum* state, mjtNum* next) {
  (void)m;
  const TorqueTable* self = (const TorqueTable*)element;
  mjtNum x = d->actuator_length[element->output];
  mjtNum place = mju_clip((x - self->angle_min) * self->per_angle, 0, self->count - 1);
  int left = place > 0 ? mjMIN((int)place, self->count - 2) : 0;  // a nan has no cell; it stays one in the torque
  mjtNum t = place - left;
  mjtNum mean = self->mean[left] + t * (self->mean[left + 1] - self->mean[left]);
  mjtNum level = self->level[left] + t * (self->level[left + 1] - self->level[left]);
  mjtNum sigma = isnan(self->presliding_stiffness) ? 0 : self->presliding_stiffness;
  return mean + hold(state, x, sigma, level, level, next);
}

const Law torque_table_law = {
    .name = "bench.torque_table",
    .numbers = kNumbers,
    .nnumber = sizeof(kNumbers) / sizeof(kNumbers[0]),
    .texts = kTexts,
    .ntext = 2,
    .size = sizeof(TorqueTable),
    .nstate = FRICTION_STATES,
    .read = read,
    .clear = clear,
    .force = force,
};
