/* The functions of the Functional Mock-up Interface 3.0 over one printed model. */

#include "instance.h"

#include "exchange.h"
#include "phases.h"
#include "records.h"
#include "stepping.h"

#include "fmi3_types.h"

/* A program that links several models statically gives each one's functions a prefix. */
#if defined FMI3_FUNCTION_PREFIX && !defined FMI3_OVERRIDE_FUNCTION_PREFIX
#define JOINED(prefix, name) prefix##name
#define PREFIXED(prefix, name) JOINED(prefix, name)
#define NAMED(name) PREFIXED(FMI3_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif

#define FUNCTION(name) EXPORTED fmi3Status NAMED(name)

static bool refuse(const instance *each, const char *text)
{
  const fmi3LogMessageCallback logger = (fmi3LogMessageCallback)each->logger;
  if (logger != NULL) {
    logger(each->environment, fmi3Error, "error", text);
  }
  return false;
}

static fmi3Status status(bool done)
{
  return done ? fmi3OK : fmi3Error;
}

/* What the model has no use for: it is there, and says so. */
static fmi3Status absent(fmi3Instance each, const char *function)
{
  char text[160];
  (void)snprintf(text, sizeof text, "%s: this model has nothing of the kind", function);
  return status(refuse(each, text));
}

/* Version, life and state. */

EXPORTED const char *NAMED(fmi3GetVersion)(void);
const char *NAMED(fmi3GetVersion)(void)
{
  return "3.0";
}

FUNCTION(fmi3SetDebugLogging)(fmi3Instance each, fmi3Boolean on, size_t count,
                              const fmi3String categories[])
{
  size_t index;
  (void)on; /* errors are always told, and there is nothing else to tell */
  for (index = 0; index < count; ++index) {
    if (categories[index] == NULL || strcmp(categories[index], "error") != 0) {
      return status(refuse(each, "set debug logging: the only category is error"));
    }
  }
  return fmi3OK;
}

EXPORTED fmi3Instance NAMED(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
    const fmi3ValueReference intermediate[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3IntermediateUpdateCallback update)
{
  const instance plain = {.environment = environment, .logger = (void (*)(void))logger};
  (void)resources, (void)visible, (void)logging, (void)early_return, (void)intermediate;
  (void)update;
  if (MODEL_EXCHANGE) {
    refuse(&plain, "instantiate co-simulation: this model is for model exchange");
    return NULL;
  }
  if (event_mode || intermediate_count > 0) {
    refuse(&plain, "instantiate co-simulation: no event mode and no intermediate variables here");
    return NULL;
  }
  return new_instance(name, token, environment, (void (*)(void))logger);
}

EXPORTED fmi3Instance NAMED(fmi3InstantiateModelExchange)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger)
{
  const instance plain = {.environment = environment, .logger = (void (*)(void))logger};
  (void)resources, (void)visible, (void)logging;
  if (!MODEL_EXCHANGE) {
    refuse(&plain, "instantiate model exchange: this model is for co-simulation");
    return NULL;
  }
  return new_instance(name, token, environment, (void (*)(void))logger);
}

EXPORTED void NAMED(fmi3FreeInstance)(fmi3Instance each)
{
  free_instance(each);
}

FUNCTION(fmi3EnterInitializationMode)(fmi3Instance each, fmi3Boolean tolerance_defined,
                                      fmi3Float64 tolerance, fmi3Float64 start,
                                      fmi3Boolean stop_defined, fmi3Float64 stop)
{
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  return status(begin(each, start));
}

FUNCTION(fmi3ExitInitializationMode)(fmi3Instance each)
{
  return status(end_initialisation(each));
}

FUNCTION(fmi3EnterEventMode)(fmi3Instance each)
{
  return status(change_phase(each, MOVING, EVENTS, "enter event mode"));
}

FUNCTION(fmi3Terminate)(fmi3Instance each)
{
  return status(end_run(each));
}

FUNCTION(fmi3Reset)(fmi3Instance each)
{
  set_to_start(each);
  return fmi3OK;
}

FUNCTION(fmi3GetFMUState)(fmi3Instance each, fmi3FMUState *state)
{
  instance_record *record = record_of(each, *state);
  *state = record != NULL ? record : *state;
  return status(record != NULL);
}

FUNCTION(fmi3SetFMUState)(fmi3Instance each, fmi3FMUState state)
{
  return status(go_back(each, state));
}

FUNCTION(fmi3FreeFMUState)(fmi3Instance each, fmi3FMUState *state)
{
  (void)each;
  free_record(state);
  return fmi3OK;
}

FUNCTION(fmi3SerializedFMUStateSize)(fmi3Instance each, fmi3FMUState state, size_t *size)
{
  (void)each, (void)state;
  *size = sizeof(instance_record);
  return fmi3OK;
}

FUNCTION(fmi3SerializeFMUState)(fmi3Instance each, fmi3FMUState state, fmi3Byte bytes[],
                                size_t size)
{
  return status(write_record(each, state, bytes, size));
}

FUNCTION(fmi3DeserializeFMUState)(fmi3Instance each, const fmi3Byte bytes[], size_t size,
                                  fmi3FMUState *state)
{
  instance_record *record = read_record(each, bytes, size);
  if (record == NULL) {
    return fmi3Error;
  }
  *state = record;
  return fmi3OK;
}

/* Values of the three types that there are. */

#define ACCESS(type, c_type, kind)                                                               \
  FUNCTION(fmi3Get##type)(fmi3Instance each, const fmi3ValueReference references[],              \
                          size_t count, c_type values[], size_t size)                            \
  {                                                                                              \
    size_t index;                                                                                \
    if (size != count) {                                                                         \
      return status(refuse(each, "fmi3Get" #type ": each variable has one value"));              \
    }                                                                                            \
    for (index = 0; index < count; ++index) {                                                    \
      const c_type *place = to_read(each, references[index], kind);                              \
      if (place == NULL) {                                                                       \
        return fmi3Error;                                                                        \
      }                                                                                          \
      values[index] = *place;                                                                    \
    }                                                                                            \
    return fmi3OK;                                                                               \
  }                                                                                              \
  FUNCTION(fmi3Set##type)(fmi3Instance each, const fmi3ValueReference references[],              \
                          size_t count, const c_type values[], size_t size)                      \
  {                                                                                              \
    size_t index;                                                                                \
    if (size != count) {                                                                         \
      return status(refuse(each, "fmi3Set" #type ": each variable has one value"));              \
    }                                                                                            \
    for (index = 0; index < count; ++index) {                                                    \
      c_type *place = to_set(each, references[index], kind);                                     \
      if (place == NULL) {                                                                       \
        return fmi3Error;                                                                        \
      }                                                                                          \
      *place = values[index];                                                                    \
    }                                                                                            \
    return fmi3OK;                                                                               \
  }

ACCESS(Float64, fmi3Float64, KIND_REAL)
ACCESS(Int32, fmi3Int32, KIND_INTEGER)
ACCESS(Boolean, fmi3Boolean, KIND_BOOLEAN)

/* Co-simulation. */

FUNCTION(fmi3DoStep)(fmi3Instance each, fmi3Float64 from, fmi3Float64 length,
                     fmi3Boolean no_state_before, fmi3Boolean *events, fmi3Boolean *terminate,
                     fmi3Boolean *early, fmi3Float64 *reached)
{
  const instance *it = each;
  bool done = false;
  (void)no_state_before;
  if (MODEL_EXCHANGE) {
    refuse(it, "do step: this model is for model exchange");
  } else {
    done = step_to(each, from, length);
  }
  *events = false;
  *terminate = false;
  *early = false;
  *reached = it->now.time;
  return status(done);
}

/* Model exchange. */

FUNCTION(fmi3EnterContinuousTimeMode)(fmi3Instance each)
{
  return status(change_phase(each, EVENTS, MOVING, "enter continuous-time mode"));
}

FUNCTION(fmi3CompletedIntegratorStep)(fmi3Instance each, fmi3Boolean no_state_before,
                                      fmi3Boolean *events, fmi3Boolean *terminate)
{
  (void)no_state_before;
  *terminate = false;
  return status(complete_step(each, events));
}

FUNCTION(fmi3UpdateDiscreteStates)(fmi3Instance each, fmi3Boolean *more, fmi3Boolean *terminate,
                                   fmi3Boolean *nominals, fmi3Boolean *states,
                                   fmi3Boolean *next_defined, fmi3Float64 *next)
{
  *terminate = false;
  *nominals = false;
  *states = false;
  *next_defined = false;
  *next = 0.0;
  return status(carry_out_events(each, more));
}

FUNCTION(fmi3SetTime)(fmi3Instance each, fmi3Float64 time)
{
  return status(set_time(each, time));
}

FUNCTION(fmi3SetContinuousStates)(fmi3Instance each, const fmi3Float64 states[], size_t size)
{
  return status(set_states(each, states, size));
}

FUNCTION(fmi3GetContinuousStates)(fmi3Instance each, fmi3Float64 states[], size_t size)
{
  return status(
      get_reals(each, model_states, model_state_count, states, size, "get continuous states"));
}

FUNCTION(fmi3GetContinuousStateDerivatives)(fmi3Instance each, fmi3Float64 derivatives[],
                                            size_t size)
{
  return status(
      get_reals(each, model_derivatives, model_state_count, derivatives, size, "get derivatives"));
}

FUNCTION(fmi3GetEventIndicators)(fmi3Instance each, fmi3Float64 indicators[], size_t size)
{
  return status(get_reals(each, model_indicators, model_indicator_count, indicators, size,
                          "get event indicators"));
}

FUNCTION(fmi3GetNominalsOfContinuousStates)(fmi3Instance each, fmi3Float64 nominals[],
                                            size_t size)
{
  return status(get_nominals(each, nominals, size));
}

FUNCTION(fmi3GetNumberOfEventIndicators)(fmi3Instance each, size_t *count)
{
  *count = model_indicator_count;
  return status(is_exchanged(each, "get number of event indicators"));
}

FUNCTION(fmi3GetNumberOfContinuousStates)(fmi3Instance each, size_t *count)
{
  *count = model_state_count;
  return status(is_exchanged(each, "get number of continuous states"));
}

#include "fmi3_absent.h"
