/* The functions of the Functional Mock-up Interface 2.0 over one printed model. */

#include "instance.h"

#include "exchange.h"
#include "phases.h"
#include "records.h"
#include "stepping.h"

#include "fmi2_types.h"

/* A program that links several models statically gives each one's functions a prefix. */
#if defined FMI2_FUNCTION_PREFIX && !defined FMI2_OVERRIDE_FUNCTION_PREFIX
#define JOINED(prefix, name) prefix##name
#define PREFIXED(prefix, name) JOINED(prefix, name)
#define NAMED(name) PREFIXED(FMI2_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif

#define FUNCTION(name) EXPORTED fmi2Status NAMED(name)

/* The interface takes the text as a format; none of the texts has a percent sign. */
static bool refuse(const instance *each, const char *text)
{
  const fmi2CallbackLogger logger = (fmi2CallbackLogger)each->logger;
  if (logger != NULL) {
    logger(each->environment, each->name != NULL ? each->name : "", fmi2Error, "logStatusError",
           text);
  }
  return false;
}

static fmi2Status status(bool done)
{
  return done ? fmi2OK : fmi2Error;
}

/* What the model has no use for: it is there, and says so. */
static fmi2Status absent(fmi2Component each, const char *function)
{
  char text[160];
  (void)snprintf(text, sizeof text, "%s: this model has nothing of the kind", function);
  return status(refuse(each, text));
}

/* Version, life and state. */

EXPORTED const char *NAMED(fmi2GetTypesPlatform)(void);
const char *NAMED(fmi2GetTypesPlatform)(void)
{
  return "default";
}

EXPORTED const char *NAMED(fmi2GetVersion)(void);
const char *NAMED(fmi2GetVersion)(void)
{
  return "2.0";
}

FUNCTION(fmi2SetDebugLogging)(fmi2Component each, fmi2Boolean on, size_t count,
                              const fmi2String categories[])
{
  size_t index;
  (void)on; /* errors are always told, and there is nothing else to tell */
  for (index = 0; index < count; ++index) {
    if (categories[index] == NULL || strcmp(categories[index], "logStatusError") != 0) {
      return status(refuse(each, "set debug logging: the only category is logStatusError"));
    }
  }
  return fmi2OK;
}

EXPORTED fmi2Component NAMED(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String token,
                                              fmi2String resources,
                                              const fmi2CallbackFunctions *functions,
                                              fmi2Boolean visible, fmi2Boolean logging)
{
  instance plain = {.environment = NULL, .logger = NULL};
  (void)resources, (void)visible, (void)logging;
  if (functions != NULL) {
    plain.environment = functions->componentEnvironment;
    plain.logger = (void (*)(void))functions->logger;
  }
  if (type != (MODEL_EXCHANGE ? fmi2ModelExchange : fmi2CoSimulation)) {
    refuse(&plain, MODEL_EXCHANGE ? "instantiate: this model is for model exchange"
                                  : "instantiate: this model is for co-simulation");
    return NULL;
  }
  return new_instance(name, token, plain.environment, plain.logger);
}

EXPORTED void NAMED(fmi2FreeInstance)(fmi2Component each)
{
  free_instance(each);
}

FUNCTION(fmi2SetupExperiment)(fmi2Component each, fmi2Boolean tolerance_defined,
                              fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined,
                              fmi2Real stop)
{
  instance *it = each;
  (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
  if (!in_phase(it, INSTANTIATED, "setup experiment")) {
    return fmi2Error;
  }
  it->now.start = start;
  return fmi2OK;
}

FUNCTION(fmi2EnterInitializationMode)(fmi2Component each)
{
  return status(begin(each, ((instance *)each)->now.start));
}

FUNCTION(fmi2ExitInitializationMode)(fmi2Component each)
{
  return status(end_initialisation(each));
}

FUNCTION(fmi2Terminate)(fmi2Component each)
{
  return status(end_run(each));
}

FUNCTION(fmi2Reset)(fmi2Component each)
{
  set_to_start(each);
  return fmi2OK;
}

FUNCTION(fmi2GetFMUstate)(fmi2Component each, fmi2FMUstate *state)
{
  instance_record *record = record_of(each, *state);
  *state = record != NULL ? record : *state;
  return status(record != NULL);
}

FUNCTION(fmi2SetFMUstate)(fmi2Component each, fmi2FMUstate state)
{
  return status(go_back(each, state));
}

FUNCTION(fmi2FreeFMUstate)(fmi2Component each, fmi2FMUstate *state)
{
  (void)each;
  free_record(state);
  return fmi2OK;
}

FUNCTION(fmi2SerializedFMUstateSize)(fmi2Component each, fmi2FMUstate state, size_t *size)
{
  (void)each, (void)state;
  *size = sizeof(instance_record);
  return fmi2OK;
}

FUNCTION(fmi2SerializeFMUstate)(fmi2Component each, fmi2FMUstate state, fmi2Byte bytes[],
                                size_t size)
{
  return status(write_record(each, state, bytes, size));
}

FUNCTION(fmi2DeSerializeFMUstate)(fmi2Component each, const fmi2Byte bytes[], size_t size,
                                  fmi2FMUstate *state)
{
  instance_record *record = read_record(each, bytes, size);
  if (record == NULL) {
    return fmi2Error;
  }
  *state = record;
  return fmi2OK;
}

/* Values. */

#define ACCESS(type, c_type, own_type, kind, stored)                                             \
  FUNCTION(fmi2Get##type)(fmi2Component each, const fmi2ValueReference references[],             \
                          size_t count, c_type values[])                                         \
  {                                                                                              \
    size_t index;                                                                                \
    for (index = 0; index < count; ++index) {                                                    \
      const own_type *place = to_read(each, references[index], kind);                            \
      if (place == NULL) {                                                                       \
        return fmi2Error;                                                                        \
      }                                                                                          \
      values[index] = *place;                                                                    \
    }                                                                                            \
    return fmi2OK;                                                                               \
  }                                                                                              \
  FUNCTION(fmi2Set##type)(fmi2Component each, const fmi2ValueReference references[],             \
                          size_t count, const c_type values[])                                   \
  {                                                                                              \
    size_t index;                                                                                \
    for (index = 0; index < count; ++index) {                                                    \
      own_type *place = to_set(each, references[index], kind);                                   \
      if (place == NULL) {                                                                       \
        return fmi2Error;                                                                        \
      }                                                                                          \
      *place = stored;                                                                           \
    }                                                                                            \
    return fmi2OK;                                                                               \
  }

ACCESS(Real, fmi2Real, double, KIND_REAL, values[index])
ACCESS(Integer, fmi2Integer, int32_t, KIND_INTEGER, values[index])
ACCESS(Boolean, fmi2Boolean, bool, KIND_BOOLEAN, values[index] != 0)

FUNCTION(fmi2GetString)(fmi2Component each, const fmi2ValueReference references[], size_t count,
                        fmi2String values[])
{
  (void)references, (void)values;
  return count == 0 ? fmi2OK : absent(each, "fmi2GetString");
}

FUNCTION(fmi2SetString)(fmi2Component each, const fmi2ValueReference references[], size_t count,
                        const fmi2String values[])
{
  (void)references, (void)values;
  return count == 0 ? fmi2OK : absent(each, "fmi2SetString");
}

FUNCTION(fmi2GetDirectionalDerivative)(fmi2Component each, const fmi2ValueReference unknowns[],
                                       size_t unknown_count, const fmi2ValueReference knowns[],
                                       size_t known_count, const fmi2Real seed[],
                                       fmi2Real sensitivity[])
{
  (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count, (void)seed;
  (void)sensitivity;
  return absent(each, "fmi2GetDirectionalDerivative");
}

/* Co-simulation. */

FUNCTION(fmi2DoStep)(fmi2Component each, fmi2Real from, fmi2Real length,
                     fmi2Boolean no_state_before)
{
  (void)no_state_before;
  if (MODEL_EXCHANGE) {
    return status(refuse(each, "do step: this model is for model exchange"));
  }
  return status(step_to(each, from, length));
}

FUNCTION(fmi2CancelStep)(fmi2Component each)
{
  return absent(each, "fmi2CancelStep");
}

FUNCTION(fmi2SetRealInputDerivatives)(fmi2Component each, const fmi2ValueReference references[],
                                      size_t count, const fmi2Integer orders[],
                                      const fmi2Real values[])
{
  (void)references, (void)orders, (void)values;
  return count == 0 ? fmi2OK : absent(each, "fmi2SetRealInputDerivatives");
}

FUNCTION(fmi2GetRealOutputDerivatives)(fmi2Component each, const fmi2ValueReference references[],
                                       size_t count, const fmi2Integer orders[],
                                       fmi2Real values[])
{
  (void)references, (void)orders, (void)values;
  return count == 0 ? fmi2OK : absent(each, "fmi2GetRealOutputDerivatives");
}

FUNCTION(fmi2GetRealStatus)(fmi2Component each, const fmi2StatusKind kind, fmi2Real *value)
{
  const instance *it = each;
  if (kind != fmi2LastSuccessfulTime) {
    return absent(each, "fmi2GetRealStatus");
  }
  *value = it->now.time;
  return fmi2OK;
}

FUNCTION(fmi2GetBooleanStatus)(fmi2Component each, const fmi2StatusKind kind, fmi2Boolean *value)
{
  if (kind != fmi2Terminated) {
    return absent(each, "fmi2GetBooleanStatus");
  }
  *value = 0; /* the model never ends a simulation by itself */
  return fmi2OK;
}

#define NO_STATUS(name, c_type)                                                                  \
  FUNCTION(name)(fmi2Component each, const fmi2StatusKind kind, c_type *value)                   \
  {                                                                                              \
    (void)kind, (void)value;                                                                     \
    return absent(each, #name);                                                                  \
  }

NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)

/* Model exchange. */

FUNCTION(fmi2EnterEventMode)(fmi2Component each)
{
  return status(change_phase(each, MOVING, EVENTS, "enter event mode"));
}

FUNCTION(fmi2NewDiscreteStates)(fmi2Component each, fmi2EventInfo *info)
{
  bool more = false;
  const bool done = carry_out_events(each, &more);
  memset(info, 0, sizeof *info);
  info->newDiscreteStatesNeeded = more;
  return status(done);
}

FUNCTION(fmi2EnterContinuousTimeMode)(fmi2Component each)
{
  return status(change_phase(each, EVENTS, MOVING, "enter continuous-time mode"));
}

FUNCTION(fmi2CompletedIntegratorStep)(fmi2Component each, fmi2Boolean no_state_before,
                                      fmi2Boolean *events, fmi2Boolean *terminate)
{
  bool event = false;
  const bool done = complete_step(each, &event);
  (void)no_state_before;
  *events = event;
  *terminate = 0;
  return status(done);
}

FUNCTION(fmi2SetTime)(fmi2Component each, fmi2Real time)
{
  return status(set_time(each, time));
}

FUNCTION(fmi2SetContinuousStates)(fmi2Component each, const fmi2Real states[], size_t size)
{
  return status(set_states(each, states, size));
}

FUNCTION(fmi2GetContinuousStates)(fmi2Component each, fmi2Real states[], size_t size)
{
  return status(
      get_reals(each, model_states, model_state_count, states, size, "get continuous states"));
}

FUNCTION(fmi2GetDerivatives)(fmi2Component each, fmi2Real derivatives[], size_t size)
{
  return status(
      get_reals(each, model_derivatives, model_state_count, derivatives, size, "get derivatives"));
}

FUNCTION(fmi2GetEventIndicators)(fmi2Component each, fmi2Real indicators[], size_t size)
{
  return status(get_reals(each, model_indicators, model_indicator_count, indicators, size,
                          "get event indicators"));
}

FUNCTION(fmi2GetNominalsOfContinuousStates)(fmi2Component each, fmi2Real nominals[], size_t size)
{
  return status(get_nominals(each, nominals, size));
}
