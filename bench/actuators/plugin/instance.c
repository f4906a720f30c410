#include "instance.h"

#include <string.h>

// Lives in mjData.plugin_data; in memory there follow the states that a step from the last `compute` leaves behind, the
// elements, law->size bytes each, and a copy of the attributes.
typedef struct Instance {
  const Law* law;
  int count;
  size_t nconfig;
} Instance;

static Instance* get(const mjData* d, int instance) {
  return (Instance*)d->plugin_data[instance];
}

static mjtNum* next_states(Instance* self) {
  return (mjtNum*)(self + 1);
}

static Element* element(Instance* self, int i) {
  char* first = (char*)(next_states(self) + self->count * self->law->nstate);
  return (Element*)(first + (size_t)i * self->law->size);
}

static char* config_copy(Instance* self) {
  return (char*)element(self, self->count);
}

static const char* config(const mjModel* m, int instance) {
  return m->plugin_attr + m->plugin_attradr[instance];
}

// Size of all attributes, each of which ends with 0.
static size_t config_size(const Law* law, const char* text) {
  const char* end = text;
  for (int i = 0; i < law->nnumber + law->ntext; i++) {
    end += strlen(end) + 1;
  }
  return (size_t)(end - text);
}

static int count_actuators(const mjModel* m, int instance) {
  int count = 0;
  for (int i = 0; i < m->nactuator; i++) {
    count += m->actuator_plugin[i] == instance;
  }
  return count;
}

int count_states(const Law* law, const mjModel* m, int instance) {
  return law->nstate * count_actuators(m, instance);
}

static void destroy(mjData* d, int instance) {
  Instance* self = get(d, instance);
  if (self && self->law->clear) {
    for (int i = 0; i < self->count; i++) {
      self->law->clear(element(self, i));
    }
  }
  mju_free(self);
  d->plugin_data[instance] = 0;
}

int init_instance(const Law* law, const mjModel* m, mjData* d, int instance) {
  int count = count_actuators(m, instance);
  size_t nconfig = config_size(law, config(m, instance));
  size_t size = sizeof(Instance) + (size_t)count * (law->nstate * sizeof(mjtNum) + law->size) + nconfig;
  Instance* self = mju_malloc(size);
  memset(self, 0, size);
  *self = (Instance){law, count, nconfig};
  memcpy(config_copy(self), config(m, instance), nconfig);
  d->plugin_data[instance] = (uintptr_t)self;

  int index = 0;
  for (int i = 0; i < m->nactuator; i++) {
    if (m->actuator_plugin[i] != instance) {
      continue;
    }
    Reader reader = {.m = m, .instance = instance, .actuator = i, .index = index, .count = count, .ok = true};
    Element* e = element(self, index++);
    e->actuator = i;
    e->output = m->actuator_outadr[i];
    read_numbers(&reader, law->numbers, law->nnumber, e);
    law->read(e, &reader);
    if (!reader.ok) {
      destroy(d, instance);
      return -1;
    }
  }
  return 0;
}

static void reset(const mjModel* m, mjtNum* plugin_state, void* plugin_data, int instance) {
  (void)plugin_data;
  mju_zero(plugin_state, m->plugin_statenum[instance]);
}

static bool same_config(Instance* self, const mjModel* m, int instance) {
  return m->plugin_attradr[instance] + (mjtSize)self->nconfig <= m->npluginattr &&
         memcmp(config_copy(self), config(m, instance), self->nconfig) == 0;
}

// A batch or a rollout may run one mjData on several models: parameters read from another model are read again.
static Instance* up_to_date(const mjModel* m, mjData* d, int instance) {
  Instance* self = get(d, instance);
  if (self && !same_config(self, m, instance)) {
    const Law* law = self->law;
    destroy(d, instance);
    init_instance(law, m, d, instance);
  }
  return get(d, instance);
}

static void compute(const mjModel* m, mjData* d, int instance, int capability_bit) {
  (void)capability_bit;
  Instance* self = up_to_date(m, d, instance);
  if (!self) {
    return;
  }
  const Law* law = self->law;
  const mjtNum* state = d->plugin_state + m->plugin_stateadr[instance];
  mjtNum* next = next_states(self);
  for (int i = 0; i < self->count; i++, state += law->nstate, next += law->nstate) {
    Element* e = element(self, i);
    mjtNum force = law->force(e, m, d, state, next);
    if (!mjACTUATORDISABLED(e->actuator)) {
      d->actuator_force[e->output] = force;
    }
  }
}

// A step takes the state that its last `compute` prepared: at the lengths and velocities of the step's start.
static void advance(const mjModel* m, mjData* d, int instance) {
  Instance* self = get(d, instance);
  if (self) {
    mju_copy(d->plugin_state + m->plugin_stateadr[instance], next_states(self), m->plugin_statenum[instance]);
  }
}

static void visualize(const mjModel* m, mjData* d, const mjvOption* opt, mjvScene* scn, int instance) {
  Instance* self = get(d, instance);
  for (int i = 0; self && self->law->draw && i < self->count; i++) {
    self->law->draw(element(self, i), m, d, opt, scn);
  }
}

void register_law(const Law* law, int (*init)(const mjModel*, mjData*, int), int (*nstate)(const mjModel*, int)) {
  if (mjp_getPlugin(law->name, NULL)) {
    return;  // a second copy of this library; MuJoCo would end the process
  }
  const char** attributes = mju_malloc((law->nnumber + law->ntext) * sizeof(*attributes));
  int nattribute = 0;
  for (int i = 0; i < law->nnumber; i++) {
    attributes[nattribute++] = law->numbers[i].name;
  }
  for (int i = 0; i < law->ntext; i++) {
    attributes[nattribute++] = law->texts[i];
  }
  mjpPlugin plugin;
  mjp_defaultPlugin(&plugin);
  plugin.name = law->name;
  plugin.nattribute = nattribute;
  plugin.attributes = attributes;
  plugin.capabilityflags = mjPLUGIN_ACTUATOR;
  plugin.nstate = nstate;
  plugin.init = init;
  plugin.destroy = destroy;
  plugin.reset = reset;
  plugin.compute = compute;
  plugin.advance = advance;
  plugin.visualize = visualize;
  mjp_registerPlugin(&plugin);  // copies the names
  mju_free(attributes);
}
