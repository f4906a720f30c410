// bench.friction: an elasto-plastic element that holds, with a level that may depend on speed, direction, load, angle.

#include "instance.h"

typedef struct Friction {
  Element element;
  double coulomb;
  double presliding_stiffness;
  double static_rise;
  double stribeck_velocity;
  double asymmetry;
  double viscous_asymmetry;
  double rolling;
  double rolling_asymmetry;
  double drag[3];  // of |v|, v^2, |v|^3
  double drag_speed;
  double load_coefficient;
  double ripple;
  double ripple_period;
  double ripple_phase;
  int tendon;  // of the transmitted torque, -1: none
} Friction;

static const Number kNumbers[] = {
    {"coulomb", offsetof(Friction, coulomb), REQUIRED, NONNEGATIVE},
    {"presliding_stiffness", offsetof(Friction, presliding_stiffness), REQUIRED, POSITIVE},
    {"static_rise", offsetof(Friction, static_rise), 0, NONNEGATIVE},
    {"stribeck_velocity", offsetof(Friction, stribeck_velocity), UNSET, POSITIVE},
    {"asymmetry", offsetof(Friction, asymmetry), 0, SIGNED_FRACTION},
    {"viscous_asymmetry", offsetof(Friction, viscous_asymmetry), 0, ANY},
    {"rolling", offsetof(Friction, rolling), 0, NONNEGATIVE},
    {"rolling_asymmetry", offsetof(Friction, rolling_asymmetry), 0, SIGNED_FRACTION},
    {"drag", offsetof(Friction, drag[0]), 0, ANY},
    {"drag_square", offsetof(Friction, drag[1]), 0, ANY},
    {"drag_cube", offsetof(Friction, drag[2]), 0, ANY},
    {"drag_speed", offsetof(Friction, drag_speed), UNSET, POSITIVE},
    {"load_coefficient", offsetof(Friction, load_coefficient), 0, NONNEGATIVE},
    {"ripple", offsetof(Friction, ripple), 0, FRACTION},
    {"ripple_period", offsetof(Friction, ripple_period), UNSET, POSITIVE},
    {"ripple_phase", offsetof(Friction, ripple_phase), 0, ANY},
};

static const char* const kTexts[] = {"element"};

static int has_drag(const Friction* self) {
  return self->drag[0] != 0 || self->drag[1] != 0 || self->drag[2] != 0;
}

// The polynomial up to drag_speed; beyond, it goes on as steep as it is there, and falls no further.
static mjtNum drag_at(const Friction* self, mjtNum speed) {
  mjtNum top = fmin(speed, self->drag_speed);
  mjtNum level = top * (self->drag[0] + top * (self->drag[1] + top * self->drag[2]));
  mjtNum slope = self->drag[0] + top * (2 * self->drag[1] + top * 3 * self->drag[2]);
  return level + (speed - top) * fmax(slope, 0);
}

static void read(Element* element, Reader* reader) {
  Friction* self = (Friction*)element;
  self->tendon = read_tendon(reader, "element");
  if (self->static_rise > 0) {
    need(reader, "stribeck_velocity", "is needed with static_rise > 0");
  }
  if (self->ripple > 0) {
    need(reader, "ripple_period", "is needed with ripple > 0");
  }
  if (has_drag(self)) {
    need(reader, "drag_speed", "is needed with drag, drag_square or drag_cube");
  }
  if (self->load_coefficient > 0) {
    need(reader, "element", "is needed with load_coefficient > 0");
  }
}

// Torque of a tendon's spring, from its stiffness polynomial and dead band.
static mjtNum spring_torque(const mjModel* m, const mjData* d, int tendon) {
  int plastic = m->tendon_plasticadr[tendon];
  const mjtNum* rest = plastic < 0 ? m->tendon_lengthspring + 2 * tendon : d->plastic + plastic;
  mjtNum length = d->ten_length[tendon];
  mjtNum x = length > rest[1] ? length - rest[1] : length < rest[0] ? length - rest[0] : 0;
  const mjtNum* poly = m->tendon_stiffnesspoly + mjNPOLY * tendon;
  return x * (m->tendon_stiffness[tendon] + x * (poly[0] + x * poly[1]));
}

static mjtNum force(Element* element, const mjModel* m, const mjData* d, const mjtNum* state, mjtNum* next) {
  const Friction* self = (const Friction*)element;
  mjtNum x = d->actuator_length[element->output];
  mjtNum v = d->actuator_velocity[element->output];
  mjtNum coulomb = self->coulomb;
  if (self->static_rise > 0) {
    mjtNum speed = v / self->stribeck_velocity;
    coulomb *= 1 + self->static_rise * exp(-speed * speed);
  }
  if (self->ripple > 0) {
    coulomb *= 1 + self->ripple * sin(2 * mjPI * x / self->ripple_period + self->ripple_phase);
  }
  mjtNum more = 0;
  if (self->load_coefficient > 0) {
    more = self->load_coefficient * fabs(spring_torque(m, d, self->tendon));
  }
  mjtNum rolling = 0;
  if (self->rolling > 0) {
    rolling = self->rolling * pow(fabs(v), 2.0 / 3.0);
  }
  mjtNum level_minus = coulomb * (1 - self->asymmetry) + rolling * (1 - self->rolling_asymmetry) + more;
  mjtNum level_plus = coulomb * (1 + self->asymmetry) + rolling * (1 + self->rolling_asymmetry) + more;
  if (has_drag(self)) {
    mjtNum drag = drag_at(self, fabs(v));
    level_minus = fmax(level_minus + drag, 0);
    level_plus = fmax(level_plus + drag, 0);
  }
  if (self->viscous_asymmetry != 0) {
    mjtNum* level = v > 0 ? &level_plus : &level_minus;
    *level = fmax(*level + self->viscous_asymmetry * v, 0);
  }
  return hold(state, x, self->presliding_stiffness, level_minus, level_plus, next);
}

const Law friction_law = {
    .name = "bench.friction",
    .numbers = kNumbers,
    .nnumber = sizeof(kNumbers) / sizeof(kNumbers[0]),
    .texts = kTexts,
    .ntext = 1,
    .size = sizeof(Friction),
    .nstate = FRICTION_STATES,
    .read = read,
    .force = force,
};
