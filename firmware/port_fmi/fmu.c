/* The core as a co-simulation slave of FMI 2.0. Its variables are the members of the core's structs,
 * in a table that tools/fmu.py generates; their value references are its indices. */
#include "timing.h"

#include <fmi2Functions.h>
#include <saddlewalk/saddlewalk.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a step depends on and what it gives. No pointers: saving it is copying it. */
typedef struct {
    saddle_config_t config;
    bool steady_start;
    saddle_input_t input;
    saddle_output_t output;
    saddle_scores_t planned;
    saddle_context_t context;
    double start_s;
    enum { INSTANTIATED, INITIALISING, STEPPING, TERMINATED } stage;
} saddle_fmu_state_t;

typedef enum { FLOAT, BYTE, WORD, LONG, FLAG } kind_t; /* in C; an enum is a WORD */
typedef enum { REAL, INTEGER, BOOLEAN } type_t;        /* in FMI */
typedef enum { PARAMETER, INPUT, OUTPUT } causality_t;

typedef struct {
    size_t offset; /* in saddle_fmu_state_t */
    kind_t kind;
    type_t type;
    causality_t causality;
} variable_t;

#include <fmu_variables.h>

#define VARIABLES (sizeof variables / sizeof variables[0])

typedef struct {
    saddle_fmu_state_t state;
    fmi2CallbackFunctions callbacks;
    char name[64]; /* of the instance, in its messages */
} fmu_t;

/* Some environments print the message without its arguments. */
static fmi2Status failed(const fmu_t *fmu, const char *message, const char *what)
{
    char text[160];
    (void)snprintf(text, sizeof text, "%s%s", message, what);
    if (fmu->callbacks.logger != NULL) {
        fmu->callbacks.logger(fmu->callbacks.componentEnvironment, fmu->name, fmi2Error,
                              "logStatusError", text);
    }
    return fmi2Error;
}

static void set_defaults(saddle_fmu_state_t *state)
{
    memset(state, 0, sizeof *state);
    state->config = saddle_config_default(1.79f, 63.3f);
    state->input.measurement = saddle_no_measurement();
}

/* ---- variables ------------------------------------------------------------------------------ */

/* A double holds every value exactly, the walked distance up to 9 million km. */
static double value_of(const saddle_fmu_state_t *state, const variable_t *variable)
{
    const void *at = (const char *)state + variable->offset;
    switch (variable->kind) {
    case FLOAT: return (double)*(const float *)at;
    case BYTE: return *(const uint8_t *)at;
    case WORD: return *(const uint32_t *)at;
    case LONG: return (double)*(const int64_t *)at;
    case FLAG: break;
    }
    return *(const bool *)at;
}

/* False if the member cannot hold the value. No LONG is ever set. */
static bool store(saddle_fmu_state_t *state, const variable_t *variable, double value)
{
    void *at = (char *)state + variable->offset;
    if (variable->kind == FLOAT) {
        *(float *)at = (float)value;
        return true;
    }
    if (!(value >= 0.0 && value <= (variable->kind == BYTE ? UINT8_MAX : UINT32_MAX))) {
        return false;
    }
    if (variable->kind == BYTE) {
        *(uint8_t *)at = (uint8_t)value;
    } else if (variable->kind == FLAG) {
        *(bool *)at = value != 0.0;
    } else {
        *(uint32_t *)at = (uint32_t)value;
    }
    return true;
}

static const variable_t *find(fmi2ValueReference reference, type_t type)
{
    return reference < VARIABLES && variables[reference].type == type ? &variables[reference]
                                                                      : NULL;
}

static fmi2Status get(const fmu_t *fmu, type_t type, fmi2ValueReference reference, double *value)
{
    const variable_t *variable = find(reference, type);
    if (variable == NULL) {
        return failed(fmu, "no such variable", "");
    }
    *value = value_of(&fmu->state, variable);
    return fmi2OK;
}

static fmi2Status set(fmu_t *fmu, type_t type, fmi2ValueReference reference, double value)
{
    const variable_t *variable = find(reference, type);
    if (variable == NULL || variable->causality == OUTPUT) {
        return failed(fmu, "no such parameter or input", "");
    }
    if (variable->causality == PARAMETER && fmu->state.stage > INITIALISING) {
        return failed(fmu, "parameters are set before the end of the initialisation", "");
    }
    if (!store(&fmu->state, variable, value)) {
        return failed(fmu, "a value is out of its type's range", "");
    }
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < nvr && status == fmi2OK; i++) {
        status = get(c, REAL, vr[i], &value[i]);
    }
    return status;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          fmi2Integer value[])
{
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < nvr && status == fmi2OK; i++) {
        double number = 0.0;
        status = get(c, INTEGER, vr[i], &number);
        value[i] = (fmi2Integer)number;
    }
    return status;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          fmi2Boolean value[])
{
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < nvr && status == fmi2OK; i++) {
        double number = 0.0;
        status = get(c, BOOLEAN, vr[i], &number);
        value[i] = number != 0.0;
    }
    return status;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                       const fmi2Real value[])
{
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < nvr && status == fmi2OK; i++) {
        status = set(c, REAL, vr[i], value[i]);
    }
    return status;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Integer value[])
{
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < nvr && status == fmi2OK; i++) {
        status = set(c, INTEGER, vr[i], value[i]);
    }
    return status;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Boolean value[])
{
    fmi2Status status = fmi2OK;
    for (size_t i = 0; i < nvr && status == fmi2OK; i++) {
        status = set(c, BOOLEAN, vr[i], value[i] != fmi2False);
    }
    return status;
}

/* ---- life of an instance -------------------------------------------------------------------- */

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean loggingOn)
{
    (void)fmuResourceLocation;
    (void)visible;
    (void)loggingOn; /* only errors are logged */
    fmu_t *fmu = calloc(1, sizeof *fmu);
    if (fmu == NULL) {
        return NULL;
    }
    fmu->callbacks = *functions;
    strncpy(fmu->name, instanceName, sizeof fmu->name - 1);
    if (fmuType != fmi2CoSimulation || strcmp(fmuGUID, SADDLE_FMU_GUID) != 0) {
        (void)failed(fmu, "only for co-simulation, by the description with GUID ", SADDLE_FMU_GUID);
        free(fmu);
        return NULL;
    }
    set_defaults(&fmu->state);
    return fmu;
}

void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    (void)c;
    (void)loggingOn;
    (void)nCategories;
    (void)categories;
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    (void)toleranceDefined;
    (void)tolerance;
    (void)stopTimeDefined;
    (void)stopTime;
    ((fmu_t *)c)->state.start_s = startTime;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    ((fmu_t *)c)->state.stage = INITIALISING;
    return fmi2OK;
}

/* One tick at a time of the simulation. */
static saddle_status_t tick_at(saddle_fmu_state_t *state, double time_s)
{
    state->input.time_us = (uint64_t)((time_s - state->start_s) * 1e6 + 0.5);
    const saddle_status_t status = saddle_tick(&state->context, &state->input, &state->output);
    (void)saddle_score_plan(&state->context, &state->output.plan, &state->planned);
    return status;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    fmu_t *fmu = c;
    saddle_fmu_state_t *state = &fmu->state;
    const char *bad = saddle_config_check(&state->config);
    if (bad != NULL) {
        return failed(fmu, "out of range, or at odds with other fields: config.", bad);
    }
    if (saddle_init(&state->context, &state->config) != SADDLE_OK) {
        return failed(fmu, "compile it with -ffp-contract=off and without -ffast-math", "");
    }
    if (state->steady_start && saddle_join(&state->context, &state->input.command) != SADDLE_OK) {
        return failed(fmu, "steady_start needs command.mode 1 and a command.speed_m_s > 0", "");
    }
    state->stage = STEPPING;
    return tick_at(state, state->start_s) == SADDLE_OK ? fmi2OK : failed(fmu, "no tick", "");
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint,
                      fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    fmu_t *fmu = c;
    const double period_s = 1e-6 * SADDLE_TICK_US;
    if (!(communicationStepSize > 0.0 && communicationStepSize < 1e6)) {
        return failed(fmu, "a step must be above 0 and below 10^6 s", "");
    }
    /* No tick is longer than the core's period. */
    const double periods = communicationStepSize / period_s;
    const uint32_t whole = (uint32_t)periods;
    const uint32_t ticks = whole + (periods - whole > 1e-9 ? 1u : 0u);
    for (uint32_t tick = 1; tick <= ticks; tick++) {
        const double time_s = currentCommunicationPoint + communicationStepSize * tick / ticks;
        if (tick_at(&fmu->state, time_s) != SADDLE_OK) {
            return failed(fmu, "time went backwards: restore a state for that", "");
        }
    }
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    ((fmu_t *)c)->state.stage = TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c)
{
    set_defaults(&((fmu_t *)c)->state);
    return fmi2OK;
}

/* ---- saved states --------------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    fmu_t *fmu = c;
    if (*FMUstate == NULL) {
        *FMUstate = malloc(sizeof fmu->state);
    }
    if (*FMUstate == NULL) {
        return failed(fmu, "no memory", "");
    }
    memcpy(*FMUstate, &fmu->state, sizeof fmu->state);
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    fmu_t *fmu = c;
    memcpy(&fmu->state, FMUstate, sizeof fmu->state);
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    (void)c;
    free(*FMUstate);
    *FMUstate = NULL;
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    (void)c;
    (void)FMUstate;
    *size = sizeof(saddle_fmu_state_t);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    if (size < sizeof(saddle_fmu_state_t)) {
        return failed(c, "the array is too short for the state", "");
    }
    memcpy(serializedState, FMUstate, sizeof(saddle_fmu_state_t));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    if (size != sizeof(saddle_fmu_state_t)) {
        return failed(c, "these bytes are no state of this FMU", "");
    }
    const fmi2Status status = fmi2GetFMUstate(c, FMUstate);
    if (status == fmi2OK) {
        memcpy(*FMUstate, serializedState, size);
    }
    return status;
}

/* ---- what the description does not offer ---------------------------------------------------- */

static fmi2Status absent(fmi2Component c)
{
    return failed(c, "the FMU does not have this function", "");
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         fmi2String value[])
{
    (void)vr;
    (void)value;
    return nvr == 0 ? fmi2OK : absent(c);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                         const fmi2String value[])
{
    (void)vr;
    (void)value;
    return nvr == 0 ? fmi2OK : absent(c);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[],
                                        size_t nKnown, const fmi2Real dvKnown[],
                                        fmi2Real dvUnknown[])
{
    (void)vUnknown_ref;
    (void)nUnknown;
    (void)vKnown_ref;
    (void)nKnown;
    (void)dvKnown;
    (void)dvUnknown;
    return absent(c);
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    (void)vr;
    (void)nvr;
    (void)order;
    (void)value;
    return absent(c);
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    (void)vr;
    (void)nvr;
    (void)order;
    (void)value;
    return absent(c);
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    return absent(c);
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    (void)s;
    (void)value;
    return absent(c);
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    (void)s;
    (void)value;
    return absent(c);
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    (void)s;
    (void)value;
    return absent(c);
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    (void)s;
    (void)value;
    return absent(c);
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    (void)s;
    (void)value;
    return absent(c);
}
