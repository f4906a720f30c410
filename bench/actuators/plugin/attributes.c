#include "attributes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  SHOWN = 40,      // characters of a value that a message repeats
  MAX_NAME = 128,  // characters of a name in a list of names
};

static const char kBlanks[] = " \t\n\r";

static const char* attribute_text(const Reader* reader, const char* name) {
  const char* text = mj_getPluginConfig(reader->m, reader->instance, name);
  return text && text[strspn(text, kBlanks)] ? text : NULL;
}

// Length without the blanks at the end.
static size_t trimmed(const char* text) {
  size_t length = strlen(text);
  while (length && strchr(kBlanks, text[length - 1])) {
    length--;
  }
  return length;
}

void fault(Reader* reader, const char* sentence) {
  if (!reader->ok) {
    return;
  }
  reader->ok = false;
  if (reader->silent) {
    return;
  }
  const char* plugin = mjp_getPluginAtSlot(reader->m->plugin[reader->instance])->name;
  const char* actuator = mj_id2name(reader->m, mjOBJ_ACTUATOR, reader->actuator);
  mju_warning("%s, actuator %d '%s': %s", plugin, reader->actuator, actuator ? actuator : "", sentence);
}

void attribute_fault(Reader* reader, const char* name, const char* rule) {
  char sentence[256];
  const char* text = attribute_text(reader, name);
  if (text) {
    size_t length = trimmed(text), shown = mjMIN(length, SHOWN);
    while (shown && shown < length && ((unsigned char)text[shown] & 0xC0) == 0x80) {
      shown--;  // whole characters of UTF-8
    }
    const char* dots = length > SHOWN ? "..." : "";
    snprintf(sentence, sizeof(sentence), "attribute %s = '%.*s%s' %s", name, (int)shown, text, dots, rule);
  } else {
    snprintf(sentence, sizeof(sentence), "attribute %s is missing; it %s", name, rule);
  }
  fault(reader, sentence);
}

// low < value < high, or low <= value < high
typedef struct Interval {
  double low;
  bool with_low;
  double high;
  const char* rule;
} Interval;

static const Interval kInterval[] = {
    [ANY] = {-INFINITY, false, INFINITY, "must be a finite number"},
    [NONNEGATIVE] = {0, true, INFINITY, "must be a finite number >= 0"},
    [POSITIVE] = {0, false, INFINITY, "must be a finite number > 0"},
    [FRACTION] = {0, true, 1, "must be a number from 0 to below 1"},
    [SIGNED_FRACTION] = {-1, false, 1, "must be a number between -1 and 1, both excluded"},
    [AT_LEAST_ONE] = {1, true, INFINITY, "must be a finite number >= 1"},
};

static bool contains(const Interval* interval, double value) {
  return (value > interval->low || (interval->with_low && value == interval->low)) && value < interval->high;
}

// Reads the number at *text and moves *text behind it and the blanks that follow. Returns NAN if there is none.
static double next_number(const char** text) {
  char* end;
  double value = strtod(*text, &end);
  size_t blanks = strspn(end, kBlanks);
  if (end == *text || !isfinite(value) || (*end && !blanks)) {
    return NAN;
  }
  *text = end + blanks;
  return value;
}

static double read_number(Reader* reader, const Number* number) {
  const Interval* interval = &kInterval[number->range];
  const char* text = attribute_text(reader, number->name);
  if (!text) {
    if (isinf(number->fallback)) {
      attribute_fault(reader, number->name, interval->rule);
    }
    return number->fallback;
  }
  double value = NAN;
  int n = 0;
  for (; *text; n++) {
    double entry = next_number(&text);
    if (!contains(interval, entry)) {
      attribute_fault(reader, number->name, interval->rule);
      return NAN;
    }
    if (n == 0 || n == reader->index) {
      value = entry;
    }
  }
  if (n != 1 && n != reader->count) {
    attribute_fault(reader, number->name, "must be one number, or one for each actuator of its plugin instance");
  }
  return value;
}

void read_numbers(Reader* reader, const Number* numbers, int count, void* parameters) {
  for (const Number* number = numbers; number < numbers + count; number++) {
    *(double*)((char*)parameters + number->offset) = read_number(reader, number);
  }
}

void need(Reader* reader, const char* name, const char* reason) {
  if (!attribute_text(reader, name)) {
    attribute_fault(reader, name, reason);
  }
}

double* read_list(Reader* reader, const char* name, int* count) {
  *count = 0;
  const char* rule = "must be finite numbers separated by blanks";
  const char* text = attribute_text(reader, name);
  if (!text) {
    attribute_fault(reader, name, rule);
    return NULL;
  }
  double* values = mju_malloc((strlen(text) + 1) / 2 * sizeof(double));  // a number and its blank take two characters
  while (*text) {
    double value = next_number(&text);
    if (isnan(value)) {
      attribute_fault(reader, name, rule);
      mju_free(values);
      return NULL;
    }
    values[(*count)++] = value;
  }
  return values;
}

int read_tendon(Reader* reader, const char* name) {
  const char* text = attribute_text(reader, name);
  if (!text) {
    return -1;
  }
  size_t size = trimmed(text);
  char* whole = mju_malloc(size + 1);
  memcpy(whole, text, size);
  whole[size] = 0;
  int tendon = mj_name2id(reader->m, mjOBJ_TENDON, whole);  // first as one name, because names may contain blanks
  mju_free(whole);
  int listed = -1;
  int words = 0;
  for (; tendon < 0 && *text; words++) {
    size_t length = strcspn(text, kBlanks);
    char word[MAX_NAME];
    if (words == reader->index && length < MAX_NAME) {
      memcpy(word, text, length);
      word[length] = 0;
      listed = mj_name2id(reader->m, mjOBJ_TENDON, word);
    }
    text += length;
    text += strspn(text, kBlanks);
  }
  if (words == reader->count) {
    tendon = listed;
  }
  if (tendon < 0) {
    attribute_fault(reader, name, "must be the name of a tendon, or one name for each actuator of its plugin instance");
  }
  return tendon;
}
