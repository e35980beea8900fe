/* The functions of the Functional Mock-up Interface 3.0 over one printed model. */

#include "instance.h"

#include "exchange.h"
#include "stepping.h"

#if defined _WIN32
#define EXPORTED __declspec(dllexport)
#elif defined __GNUC__
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

/* A program that links several models statically gives each one's functions a prefix. */
#if defined FMI3_FUNCTION_PREFIX && !defined FMI3_OVERRIDE_FUNCTION_PREFIX
#define JOINED(prefix, name) prefix##name
#define PREFIXED(prefix, name) JOINED(prefix, name)
#define NAMED(name) PREFIXED(FMI3_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif

/* Where the standard's own headers are included first, they check every function below. */
#ifndef fmi3FunctionTypes_h
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
  fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent
} fmi3DependencyKind;
typedef enum {
  fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged
} fmi3IntervalQualifier;
typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef bool fmi3Clock;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String,
                                       fmi3String);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean *, fmi3Float64 *);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);
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

EXPORTED fmi3Instance NAMED(fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock)
{
  const instance plain = {.environment = environment, .logger = (void (*)(void))logger};
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update;
  (void)lock, (void)unlock;
  refuse(&plain, "instantiate scheduled execution: this model has no clocks");
  return NULL;
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
  instance *it = each;
  if (it->now.phase == INSTANTIATED || it->now.phase == TERMINATED) {
    return status(refuse(it, "terminate: nothing is running"));
  }
  it->now.phase = TERMINATED;
  return fmi3OK;
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
  const instance_record *record = state;
  if (!is_record(each, record)) {
    return fmi3Error;
  }
  ((instance *)each)->now = record->state;
  return fmi3OK;
}

FUNCTION(fmi3FreeFMUState)(fmi3Instance each, fmi3FMUState *state)
{
  (void)each;
  if (state != NULL) {
    free(*state);
    *state = NULL;
  }
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
  if (!is_record(each, state) || !fits_record(each, size)) {
    return fmi3Error;
  }
  memcpy(bytes, state, size);
  return fmi3OK;
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

/* Values: three types are there. */

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

#define NO_ACCESS(type, c_type)                                                                  \
  FUNCTION(fmi3Get##type)(fmi3Instance each, const fmi3ValueReference references[],              \
                          size_t count, c_type values[], size_t size)                            \
  {                                                                                              \
    (void)references, (void)values, (void)size;                                                  \
    return count == 0 ? fmi3OK : absent(each, "fmi3Get" #type);                                  \
  }                                                                                              \
  FUNCTION(fmi3Set##type)(fmi3Instance each, const fmi3ValueReference references[],              \
                          size_t count, const c_type values[], size_t size)                      \
  {                                                                                              \
    (void)references, (void)values, (void)size;                                                  \
    return count == 0 ? fmi3OK : absent(each, "fmi3Set" #type);                                  \
  }

NO_ACCESS(Float32, fmi3Float32)
NO_ACCESS(Int8, fmi3Int8)
NO_ACCESS(UInt8, fmi3UInt8)
NO_ACCESS(Int16, fmi3Int16)
NO_ACCESS(UInt16, fmi3UInt16)
NO_ACCESS(UInt32, fmi3UInt32)
NO_ACCESS(Int64, fmi3Int64)
NO_ACCESS(UInt64, fmi3UInt64)
NO_ACCESS(String, fmi3String)

FUNCTION(fmi3GetBinary)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                        size_t sizes[], fmi3Binary values[], size_t size)
{
  (void)references, (void)sizes, (void)values, (void)size;
  return count == 0 ? fmi3OK : absent(each, "fmi3GetBinary");
}

FUNCTION(fmi3SetBinary)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                        const size_t sizes[], const fmi3Binary values[], size_t size)
{
  (void)references, (void)sizes, (void)values, (void)size;
  return count == 0 ? fmi3OK : absent(each, "fmi3SetBinary");
}

FUNCTION(fmi3GetClock)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                       fmi3Clock values[])
{
  (void)references, (void)values;
  return count == 0 ? fmi3OK : absent(each, "fmi3GetClock");
}

FUNCTION(fmi3SetClock)(fmi3Instance each, const fmi3ValueReference references[], size_t count,
                       const fmi3Clock values[])
{
  (void)references, (void)values;
  return count == 0 ? fmi3OK : absent(each, "fmi3SetClock");
}

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

FUNCTION(fmi3EnterStepMode)(fmi3Instance each)
{
  return absent(each, "fmi3EnterStepMode");
}

FUNCTION(fmi3GetOutputDerivatives)(fmi3Instance each, const fmi3ValueReference references[],
                                   size_t count, const fmi3Int32 orders[], fmi3Float64 values[],
                                   size_t size)
{
  (void)references, (void)orders, (void)values, (void)size;
  return count == 0 ? fmi3OK : absent(each, "fmi3GetOutputDerivatives");
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
  *events = false;
  *terminate = false;
  return status(complete_step(each));
}

FUNCTION(fmi3UpdateDiscreteStates)(fmi3Instance each, fmi3Boolean *more, fmi3Boolean *terminate,
                                   fmi3Boolean *nominals, fmi3Boolean *states,
                                   fmi3Boolean *next_defined, fmi3Float64 *next)
{
  *more = false;
  *terminate = false;
  *nominals = false;
  *states = false;
  *next_defined = false;
  *next = 0.0;
  return status(carry_out_events(each, more));
}

FUNCTION(fmi3EvaluateDiscreteStates)(fmi3Instance each)
{
  return absent(each, "fmi3EvaluateDiscreteStates");
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

/* Clocks, partial derivatives and structural parameters: none. */

FUNCTION(fmi3GetNumberOfVariableDependencies)(fmi3Instance each, fmi3ValueReference reference,
                                              size_t *count)
{
  (void)reference, (void)count;
  return absent(each, "fmi3GetNumberOfVariableDependencies");
}

FUNCTION(fmi3GetVariableDependencies)(fmi3Instance each, fmi3ValueReference dependent,
                                      size_t places[], fmi3ValueReference independents[],
                                      size_t independent_places[], fmi3DependencyKind kinds[],
                                      size_t count)
{
  (void)dependent, (void)places, (void)independents, (void)independent_places, (void)kinds;
  (void)count;
  return absent(each, "fmi3GetVariableDependencies");
}

#define NO_DERIVATIVE(name)                                                                      \
  FUNCTION(name)(fmi3Instance each, const fmi3ValueReference unknowns[], size_t unknown_count,   \
                 const fmi3ValueReference knowns[], size_t known_count,                          \
                 const fmi3Float64 seed[], size_t seed_size, fmi3Float64 sensitivity[],          \
                 size_t sensitivity_size)                                                        \
  {                                                                                              \
    (void)unknowns, (void)unknown_count, (void)knowns, (void)known_count, (void)seed;            \
    (void)seed_size, (void)sensitivity, (void)sensitivity_size;                                  \
    return absent(each, #name);                                                                  \
  }

NO_DERIVATIVE(fmi3GetDirectionalDerivative)
NO_DERIVATIVE(fmi3GetAdjointDerivative)

FUNCTION(fmi3EnterConfigurationMode)(fmi3Instance each)
{
  return absent(each, "fmi3EnterConfigurationMode");
}

FUNCTION(fmi3ExitConfigurationMode)(fmi3Instance each)
{
  return absent(each, "fmi3ExitConfigurationMode");
}

FUNCTION(fmi3GetIntervalDecimal)(fmi3Instance each, const fmi3ValueReference references[],
                                 size_t count, fmi3Float64 intervals[],
                                 fmi3IntervalQualifier qualifiers[])
{
  (void)references, (void)count, (void)intervals, (void)qualifiers;
  return absent(each, "fmi3GetIntervalDecimal");
}

FUNCTION(fmi3GetIntervalFraction)(fmi3Instance each, const fmi3ValueReference references[],
                                  size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                  fmi3IntervalQualifier qualifiers[])
{
  (void)references, (void)count, (void)counters, (void)resolutions, (void)qualifiers;
  return absent(each, "fmi3GetIntervalFraction");
}

#define NO_DECIMAL(name, c_type)                                                                 \
  FUNCTION(name)(fmi3Instance each, const fmi3ValueReference references[], size_t count,         \
                 c_type values[])                                                                \
  {                                                                                              \
    (void)references, (void)count, (void)values;                                                 \
    return absent(each, #name);                                                                  \
  }

NO_DECIMAL(fmi3GetShiftDecimal, fmi3Float64)
NO_DECIMAL(fmi3SetShiftDecimal, const fmi3Float64)
NO_DECIMAL(fmi3SetIntervalDecimal, const fmi3Float64)

#define NO_FRACTION(name, c_type)                                                                \
  FUNCTION(name)(fmi3Instance each, const fmi3ValueReference references[], size_t count,         \
                 c_type counters[], c_type resolutions[])                                        \
  {                                                                                              \
    (void)references, (void)count, (void)counters, (void)resolutions;                            \
    return absent(each, #name);                                                                  \
  }

NO_FRACTION(fmi3GetShiftFraction, fmi3UInt64)
NO_FRACTION(fmi3SetShiftFraction, const fmi3UInt64)
NO_FRACTION(fmi3SetIntervalFraction, const fmi3UInt64)

FUNCTION(fmi3ActivateModelPartition)(fmi3Instance each, fmi3ValueReference clock,
                                     fmi3Float64 time)
{
  (void)clock, (void)time;
  return absent(each, "fmi3ActivateModelPartition");
}
