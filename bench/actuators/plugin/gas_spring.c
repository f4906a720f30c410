// bench.gas_spring: hydropneumatic cylinder that pulls along a spatial tendon, Eq. (8) of the paper and what a real one
// adds: polytropic exponent, gas loss, warming by compression, seal friction.

#include "instance.h"

// T / T0 - 1, and the gap l_c - l [m], at the start of the last step; gap 0: unknown yet. They are apart from those of the
// seal, whose friction may be forgotten where the gas remembers (replay.c).
enum { TEMPERATURE_RISE = FRICTION_STATES, GAP, GAS_STATES };

typedef struct GasSpring {
  Element element;
  double constant;
  double critical_length;
  double exponent;
  double reference_length;
  double gas_amount;
  double heat_capacity_ratio;
  double relaxation_time;
  double seal_friction;
  double seal_presliding;
  int tendon;
  bool warned;
} GasSpring;

static const Number kNumbers[] = {
    {"constant", offsetof(GasSpring, constant), REQUIRED, POSITIVE},
    {"critical_length", offsetof(GasSpring, critical_length), REQUIRED, POSITIVE},
    {"exponent", offsetof(GasSpring, exponent), 1, POSITIVE},
    {"reference_length", offsetof(GasSpring, reference_length), UNSET, NONNEGATIVE},
    {"gas_amount", offsetof(GasSpring, gas_amount), 1, NONNEGATIVE},
    {"heat_capacity_ratio", offsetof(GasSpring, heat_capacity_ratio), 1, AT_LEAST_ONE},
    {"relaxation_time", offsetof(GasSpring, relaxation_time), UNSET, POSITIVE},
    {"seal_friction", offsetof(GasSpring, seal_friction), 0, FRACTION},
    {"seal_presliding", offsetof(GasSpring, seal_presliding), UNSET, POSITIVE},
};

// A tendon as long as l_c would have pressed the gas into nothing; the gap l_c - l is kept above this part of l_c.
static const double kSmallestGap = 1e-3;

// Proportions of the picture, as parts of l_c.
static const double kHousing = 0.5;
static const double kHousingRadius = 0.045;
static const double kRodRadius = 0.022;
static const double kMostHousing = 0.95;  // of the length between the end sites, so that the rod always shows

static void read(Element* element, Reader* reader) {
  GasSpring* self = (GasSpring*)element;
  const mjModel* m = reader->m;
  self->tendon = m->actuator_trnid[2 * element->actuator];
  bool spatial = m->actuator_trntype[element->actuator] == mjTRN_TENDON &&
                 m->wrap_type[m->tendon_adr[self->tendon]] == mjWRAP_SITE;
  if (!spatial) {
    fault(reader, "must act on a spatial tendon");
  }
  if (self->exponent != 1) {
    need(reader, "reference_length", "is needed with exponent other than 1");
  }
  if (self->reference_length >= self->critical_length) {
    attribute_fault(reader, "reference_length", "must be below critical_length");
  }
  if (self->heat_capacity_ratio > 1) {
    need(reader, "relaxation_time", "is needed with heat_capacity_ratio > 1");
  }
  if (self->seal_friction > 0) {
    need(reader, "seal_presliding", "is needed with seal_friction > 0");
  }
}

// Gap l_c - l, kept above zero.
static mjtNum gap_at(GasSpring* self, mjtNum length) {
  mjtNum gap = self->critical_length - length;
  mjtNum smallest = kSmallestGap * self->critical_length;
  if (gap >= smallest || isnan(gap)) {
    return gap;
  }
  if (!self->warned) {
    self->warned = true;
    mju_warning("bench.gas_spring, actuator %d: length %g m reaches critical_length %g m; the gap is held at %g m",
                self->element.actuator, length, self->critical_length, smallest);
  }
  return smallest;
}

// T / T0 - 1 one step after `rise`, for a gap that changes at a constant relative rate meanwhile. Exact solution of
// y' = -(gamma - 1) (V'/V) y - (y - 1) / tau.
static mjtNum temperature_rise(const GasSpring* self, mjtNum rise, mjtNum old_gap, mjtNum gap, mjtNum dt) {
  mjtNum compression = (self->heat_capacity_ratio - 1) * log(old_gap / gap);
  mjtNum decay = dt / self->relaxation_time - compression;
  mjtNum gain = decay == 0 ? 1 : -expm1(-decay) / decay;
  return rise * exp(-decay) + compression * gain;
}

static mjtNum force(Element* element, const mjModel* m, const mjData* d, const mjtNum* state, mjtNum* next) {
  GasSpring* self = (GasSpring*)element;
  mjtNum length = d->actuator_length[element->output];
  mjtNum gap = gap_at(self, length);

  mjtNum pull = self->gas_amount * self->constant / gap;
  if (self->exponent != 1) {
    pull *= pow((self->critical_length - self->reference_length) / gap, self->exponent - 1);
  }
  next[TEMPERATURE_RISE] = state[TEMPERATURE_RISE];
  if (self->heat_capacity_ratio > 1) {
    if (state[GAP] > 0) {
      next[TEMPERATURE_RISE] = temperature_rise(self, state[TEMPERATURE_RISE], state[GAP], gap, m->opt.timestep);
    }
    pull *= 1 + next[TEMPERATURE_RISE];
  }
  next[GAP] = gap;
  mjtNum level = self->seal_friction * pull;
  mjtNum sigma = self->seal_friction > 0 ? self->seal_presliding : 0;
  return hold(state, length, sigma, level, level, next) - pull;
}

static void add_cylinder(mjvScene* scn, mjtNum radius, const mjtNum* from, const mjtNum* to, const float* rgba) {
  if (scn->ngeom >= scn->maxgeom) {
    return;
  }
  mjvGeom* geom = scn->geoms + scn->ngeom++;
  mjv_initGeom(geom, mjGEOM_CYLINDER, NULL, NULL, NULL, rgba);
  mjv_connector(geom, mjGEOM_CYLINDER, radius, from, to);
  geom->category = mjCAT_DYNAMIC;
}

// Draws housing and rod between the end sites of the tendon.
static void draw(const Element* element, const mjModel* m, const mjData* d, const mjvOption* opt, mjvScene* scn) {
  const GasSpring* self = (const GasSpring*)element;
  int group = mjMAX(0, mjMIN(mjNGROUP - 1, m->tendon_group[self->tendon]));
  if (!opt->tendongroup[group]) {
    return;
  }
  int first = m->tendon_adr[self->tendon];
  int last = first + m->tendon_num[self->tendon] - 1;
  const mjtNum* from = d->site_xpos + 3 * m->wrap_objid[first];
  const mjtNum* to = d->site_xpos + 3 * m->wrap_objid[last];
  mjtNum along[3], end[3];
  mju_sub3(along, to, from);
  mjtNum distance = mju_normalize3(along);
  mju_addScl3(end, from, along, mjMIN(kHousing * self->critical_length, kMostHousing * distance));
  static const float steel[4] = {0.75f, 0.75f, 0.78f, 1};
  add_cylinder(scn, kHousingRadius * self->critical_length, from, end, m->tendon_rgba + 4 * self->tendon);
  add_cylinder(scn, kRodRadius * self->critical_length, from, to, steel);
}

const Law gas_spring_law = {
    .name = "bench.gas_spring",
    .numbers = kNumbers,
    .nnumber = sizeof(kNumbers) / sizeof(kNumbers[0]),
    .size = sizeof(GasSpring),
    .nstate = GAS_STATES,
    .read = read,
    .force = force,
    .draw = draw,
};
