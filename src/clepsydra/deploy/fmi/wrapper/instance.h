/* One instance of the model: its memory, the phase of its life, and who may read and set what.
   Both interfaces of the standard, 2.0 and 3.0, rest on this; model.h describes the model. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Who sets a variable: the importer at any time, the importer apart from the continuous motion,
   the importer before the simulation begins, or nobody. */
typedef enum { ROLE_INPUT, ROLE_PARAMETER, ROLE_START, ROLE_RESULT } variable_role;
typedef enum { KIND_REAL, KIND_INTEGER, KIND_BOOLEAN } variable_kind;
typedef struct {
  variable_role role;
  variable_kind kind;
  size_t place; /* in the memory of the model */
} model_variable;

#include "model.h"

#if defined _WIN32
#define EXPORTED __declspec(dllexport)
#elif defined __GNUC__
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

typedef enum { INSTANTIATED, INITIALISING, EVENTS, MOVING, STEPPING, TERMINATED } instance_phase;

/* Everything that changes, so that a copy of it is a copy of the instance's state. */
typedef struct {
  instance_phase phase;
  bool stale;    /* the results do not belong to the present inputs, parameters and states */
  double start;  /* [s] */
  double time;   /* [s] */
  double steps;  /* model steps made since the start, a whole number */
  double part;   /* of the next one: the fraction that is made too */
  model_memory memory;
  double kept[sizeof model_memories / sizeof *model_memories]; /* see exchange.h */
} instance_snapshot;

typedef struct {
  instance_snapshot now;
  char *name;
  void *environment;
  void (*logger)(void); /* of the type that the interface defines */
} instance;

/* Sends a text to the importer; returns false, so that a refusal can be returned at once. */
static bool refuse(const instance *each, const char *text);

static void set_to_start(instance *each)
{
  memset(&each->now, 0, sizeof each->now);
  model_start(&each->now.memory);
  each->now.phase = INSTANTIATED;
  each->now.stale = true;
}

static instance *new_instance(const char *name, const char *token, void *environment,
                              void (*logger)(void))
{
  instance plain = {.environment = environment, .logger = logger};
  instance *each;
  size_t length;
  if (name == NULL || token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
    refuse(&plain, "instantiate: the token is not that of this model description");
    return NULL;
  }
  length = strlen(name) + 1;
  each = calloc(1, sizeof *each);
  if (each != NULL) {
    each->name = malloc(length);
  }
  if (each == NULL || each->name == NULL) {
    free(each);
    refuse(&plain, "instantiate: there is not enough memory");
    return NULL;
  }
  memcpy(each->name, name, length);
  each->environment = environment;
  each->logger = logger;
  set_to_start(each);
  return each;
}

static void free_instance(instance *each)
{
  if (each != NULL) {
    free(each->name);
    free(each);
  }
}

static bool in_phase(const instance *each, instance_phase phase, const char *function)
{
  char text[160];
  if (each->now.phase == phase) {
    return true;
  }
  (void)snprintf(text, sizeof text, "%s: not allowed in this phase of the simulation", function);
  return refuse(each, text);
}

/* Brings the results up to date where they are a function of what is set: in model exchange
   always, in co-simulation until the first step; then they hold from one model step to the next. */
static void refresh(instance *each)
{
  const instance_phase phase = each->now.phase;
  if (each->now.stale && (MODEL_EXCHANGE || phase == INSTANTIATED || phase == INITIALISING)) {
    model_show(&each->now.memory);
    each->now.stale = false;
  }
}

/* Returns where a variable is, or NULL. The number 0 is that of time. */
static void *place_of(instance *each, uint32_t reference, variable_kind kind)
{
  char text[160];
  if (reference >= model_variable_count || model_variables[reference].kind != kind) {
    (void)snprintf(text, sizeof text, "value reference %lu: no variable of this type has it",
                   (unsigned long)reference);
    refuse(each, text);
    return NULL;
  }
  if (reference == 0) {
    return &each->now.time;
  }
  return (char *)&each->now.memory + model_variables[reference].place;
}

static const void *to_read(instance *each, uint32_t reference, variable_kind kind)
{
  const void *place = place_of(each, reference, kind);
  if (place != NULL && model_variables[reference].role == ROLE_RESULT) {
    refresh(each);
  }
  return place;
}

static bool may_set(const instance *each, variable_role role)
{
  const instance_phase phase = each->now.phase;
  switch (role) {
  case ROLE_INPUT:
    return phase != TERMINATED;
  case ROLE_PARAMETER:
    return phase != TERMINATED && phase != MOVING;
  case ROLE_START:
    return phase == INSTANTIATED || phase == INITIALISING;
  default:
    return false;
  }
}

static void *to_set(instance *each, uint32_t reference, variable_kind kind)
{
  char text[160];
  void *place = place_of(each, reference, kind);
  if (place != NULL && !may_set(each, model_variables[reference].role)) {
    (void)snprintf(text, sizeof text, "value reference %lu: it cannot be set now",
                   (unsigned long)reference);
    refuse(each, text);
    return NULL;
  }
  each->now.stale = true;
  return place;
}

#endif
