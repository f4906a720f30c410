// Puts attributes and states of all kinds through the three laws, without MuJoCo: its few functions that they call stand
// here. Built with sanitizers by test_fuzz.py, so that a read beyond an array or a cast that has no value ends it.
//
//     driver SEED COUNT    prints how many elements were accepted, and how many forces were computed

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

enum { MOST_TEXT = 4000, MOST_ATTRIBUTES = 32 };

static uint64_t seed_;
static char texts_[MOST_ATTRIBUTES][MOST_TEXT];
static const Law* law_;

static uint64_t next_random(void) {  // xorshift64*, Vigna (2016)
  seed_ ^= seed_ >> 12;
  seed_ ^= seed_ << 25;
  seed_ ^= seed_ >> 27;
  return seed_ * 2685821657736338717ULL;
}

static int below(int n) {
  return (int)((next_random() >> 33) % (uint64_t)n);
}

static double odd_number(void) {
  static const double odd[] = {0, -0.0, 1, -1, 0.5, 2, 1e-310, -1e-310, 5e-324, 1e-3, 1e3, 1e9, 1e155, 1e300,
                               1.7e308, -1.7e308, 3.14, INFINITY, -INFINITY, NAN};
  int n = (int)(sizeof(odd) / sizeof(odd[0]));
  int which = below(n + 8);
  return which < n ? odd[which] : ((double)below(2000001) - 1e6) * 1e-6;
}

static void odd_text(char* text, int most_words) {
  static const char* const words[] = {"", " ", "nan", "inf", "-inf", "1e999", "0x1p-1074", "e", "1e", "--1", "1,5",
                                      "\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9\xc3\xa9"};
  int n = below(4) ? 1 : below(most_words) + 1;
  size_t length = 0;
  text[0] = 0;
  for (int i = 0; i < n && length < MOST_TEXT - 500; i++) {
    if (below(40) == 0) {
      length += (size_t)snprintf(text + length, MOST_TEXT - length, "%s ", words[below(12)]);
    } else {
      length += (size_t)snprintf(text + length, MOST_TEXT - length, "%.17g%s", odd_number(), below(9) ? " " : "\n");
    }
  }
}

// A number that the range allows, or nothing where that is allowed too.
static void fitting_text(char* text, const Number* number) {
  double share = below(1000) / 1000.0;
  double value = number->range == FRACTION || number->range == SIGNED_FRACTION || number->range == ANY ? share
                 : number->range == AT_LEAST_ONE ? 1 + share : pow(10, 6 * share - 3);
  if (below(2) && !isinf(number->fallback)) {
    text[0] = 0;
  } else {
    snprintf(text, MOST_TEXT, "%.17g", value);
  }
}

const char* mj_getPluginConfig(const mjModel* m, int instance, const char* name) {
  (void)m, (void)instance;
  for (int i = 0; i < law_->nnumber + law_->ntext; i++) {
    const char* own = i < law_->nnumber ? law_->numbers[i].name : law_->texts[i - law_->nnumber];
    if (strcmp(own, name) == 0) {
      return texts_[i];
    }
  }
  return NULL;
}

void mju_warning(const char* message, ...) {
  char told[1024];
  va_list arguments;
  va_start(arguments, message);
  vsnprintf(told, sizeof(told), message, arguments);
  va_end(arguments);
}

void* mju_malloc(size_t size) { return malloc(size); }
void mju_free(void* pointer) { free(pointer); }
void mju_zero(mjtNum* values, int n) { memset(values, 0, (size_t)n * sizeof(mjtNum)); }
void mju_copy(mjtNum* to, const mjtNum* from, int n) { memcpy(to, from, (size_t)n * sizeof(mjtNum)); }
mjtNum mju_clip(mjtNum x, mjtNum low, mjtNum high) { return x < low ? low : x > high ? high : x; }
const char* mj_id2name(const mjModel* m, int type, int id) { (void)m, (void)type, (void)id; return "one"; }
int mj_name2id(const mjModel* m, int type, const char* name) { (void)m, (void)type; return strcmp(name, "t") ? -1 : 0; }
const mjpPlugin* mjp_getPluginAtSlot(int slot) {
  (void)slot;
  static mjpPlugin plugin;
  plugin.name = law_->name;
  return &plugin;
}
const mjpPlugin* mjp_getPlugin(const char* name, int* slot) { (void)name, (void)slot; return NULL; }
void mjp_defaultPlugin(mjpPlugin* plugin) { memset(plugin, 0, sizeof(*plugin)); }
int mjp_registerPlugin(const mjpPlugin* plugin) { (void)plugin; return 0; }
void mjv_initGeom(mjvGeom* g, int t, const mjtNum* s, const mjtNum* p, const mjtNum* r, const float* c) {
  (void)g, (void)t, (void)s, (void)p, (void)r, (void)c;
}
void mjv_connector(mjvGeom* g, int t, mjtNum w, const mjtNum* from, const mjtNum* to) {
  (void)g, (void)t, (void)w, (void)from, (void)to;
}
void mju_sub3(mjtNum r[3], const mjtNum a[3], const mjtNum b[3]) { (void)r, (void)a, (void)b; }
void mju_addScl3(mjtNum r[3], const mjtNum a[3], const mjtNum b[3], mjtNum s) { (void)r, (void)a, (void)b, (void)s; }
mjtNum mju_normalize3(mjtNum v[3]) { (void)v; return 0; }

int main(int argc, char** argv) {
  seed_ = argc > 1 ? strtoull(argv[1], NULL, 10) * 2 + 1 : 1;
  int count = argc > 2 ? atoi(argv[2]) : 1000;
  const Law* const laws[] = {&friction_law, &gas_spring_law, &torque_table_law};
  mjtNum lengths[1], speeds[1], tendon_lengths[1], stiffness[1], poly[mjNPOLY], rest[2];
  int plugin[1] = {0}, transmission[2] = {0, -1}, kind[1], wrap[1] = {mjWRAP_SITE}, wraps[1] = {0}, plastic[1] = {-1};
  mjModel model = {0};
  mjData data = {0};
  model.plugin = plugin;
  model.actuator_trnid = transmission;
  model.actuator_trntype = kind;
  model.wrap_type = wrap;
  model.tendon_adr = wraps;
  model.tendon_plasticadr = plastic;
  model.tendon_lengthspring = rest;
  model.tendon_stiffness = stiffness;
  model.tendon_stiffnesspoly = poly;
  data.actuator_length = lengths;
  data.actuator_velocity = speeds;
  data.ten_length = tendon_lengths;
  long accepted = 0, forces = 0;
  for (int i = 0; i < count; i++) {
    law_ = laws[below(3)];
    for (int k = 0; k < law_->nnumber + law_->ntext; k++) {
      bool is_text = k >= law_->nnumber;
      if (is_text || below(15) == 0) {
        odd_text(texts_[k], is_text ? 200 : 3);
      } else {
        fitting_text(texts_[k], law_->numbers + k);
      }
      if (is_text && law_ == &friction_law && below(2)) {
        strcpy(texts_[k], "t");
      }
      if (is_text && law_ == &torque_table_law && k > law_->nnumber && below(2)) {
        strcpy(texts_[k], texts_[k - 1]);
      }
    }
    kind[0] = below(4) ? mjTRN_TENDON : mjTRN_JOINT;
    model.opt.timestep = odd_number();
    Reader reader = {.m = &model, .index = below(3), .count = below(4) ? 1 : 3, .ok = true, .silent = below(2) == 0};
    if (reader.count == 1) {
      reader.index = 0;
    }
    Element* element = calloc(1, law_->size);
    read_numbers(&reader, law_->numbers, law_->nnumber, element);
    law_->read(element, &reader);
    accepted += reader.ok;
    for (int k = 0; reader.ok && k < 20; k++) {
      mjtNum state[8], next[8];
      for (int s = 0; s < law_->nstate; s++) {
        state[s] = odd_number();
      }
      lengths[0] = odd_number(), speeds[0] = odd_number(), tendon_lengths[0] = odd_number();
      stiffness[0] = odd_number(), rest[0] = odd_number(), rest[1] = odd_number();
      for (int p = 0; p < mjNPOLY; p++) {
        poly[p] = odd_number();
      }
      law_->force(element, &model, &data, state, next);
      forces++;
    }
    if (law_->clear) {
      law_->clear(element);
    }
    free(element);
  }
  printf("%ld accepted, %ld forces\n", accepted, forces);
  return 0;
}
