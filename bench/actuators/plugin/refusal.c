// Whether a model whose plugin attributes were written over would still be accepted: what compiling it would find out.

#include <string.h>

#include "instance.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static const Law* law_of(const mjModel* m, int instance) {
  const Law* laws[] = {&friction_law, &gas_spring_law, &torque_table_law};
  const char* name = mjp_getPluginAtSlot(m->plugin[instance])->name;
  for (int i = 0; i < 3; i++) {
    if (strcmp(laws[i]->name, name) == 0) {
      return laws[i];
    }
  }
  return NULL;
}

EXPORT int bench_refuses(const mjModel* m, int instance);

// Returns 1 when the law of a plugin instance refuses its attributes in the model for one of its actuators, else 0.
int bench_refuses(const mjModel* m, int instance) {
  const Law* law = law_of(m, instance);
  int count = 0;
  for (int i = 0; i < m->nactuator; i++) {
    count += m->actuator_plugin[i] == instance;
  }
  int index = 0;
  for (int actuator = 0; law && actuator < m->nactuator; actuator++) {
    if (m->actuator_plugin[actuator] != instance) {
      continue;
    }
    Reader reader = {.m = m, .instance = instance, .actuator = actuator, .index = index++, .count = count, .ok = true,
                     .silent = true};
    Element* element = mju_malloc(law->size);
    memset(element, 0, law->size);
    element->actuator = actuator;
    element->output = m->actuator_outadr[actuator];
    read_numbers(&reader, law->numbers, law->nnumber, element);
    law->read(element, &reader);
    if (law->clear) {
      law->clear(element);
    }
    mju_free(element);
    if (!reader.ok) {
      return 1;
    }
  }
  return 0;
}
