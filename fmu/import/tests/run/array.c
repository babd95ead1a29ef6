/* A unit of FMI 3.0 with arrays and strings: y = gain * u, both with as many elements as the structural parameter n says.
   Its text tells how many steps it took, and what it is called by its string input; it takes steps of one length only.
   Compiled by the tests with -D switches:
   DISCARD  it takes steps of any length up to so many seconds, and discards longer ones. Its speed (m/s) wears 1 um
            for each metre then.
   REACHED  an expression for the time that it says it reached, of `time` and `step`
   EXCHANGE  Model Exchange in place of Co-Simulation: one state, which grows as its speed says; STATES, INDICATORS  how
   many it says it has; NOMINAL  the nominal value of the state */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define E __attribute__((visibility("default")))
#define MOST 8

typedef struct {
    uint64_t n;
    int configuring;
    long steps;
    double time, gain, u[MOST], speed, wear; /* the wear is the state of Model Exchange */
    char text[64], called[16];
} Unit;

E const char *fmi3GetVersion(void) { return "3.0"; }
E void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path, bool visible, bool logging,
                                    bool events, bool early, const uint32_t *required, size_t n, void *environment,
                                    void *log, void *update) {
    Unit *unit = calloc(1, sizeof(Unit));
    unit->n = 2;
    unit->gain = 2;
    return unit;
}
E void fmi3FreeInstance(void *u) { free(u); }
E int fmi3EnterConfigurationMode(void *u) { return ((Unit *)u)->configuring = 1, 0; }
E int fmi3ExitConfigurationMode(void *u) { return ((Unit *)u)->configuring = 0, 0; }
E int fmi3EnterInitializationMode(void *u, bool t, double tolerance, double start, bool s, double stop) {
    ((Unit *)u)->time = start;
    return 0;
}
E int fmi3ExitInitializationMode(void *u) { return 0; }
E int fmi3SetUInt64(void *u, const uint32_t *r, size_t n, const uint64_t *v, size_t nv) {
    Unit *unit = u;
    if (r[0] != 1 || !unit->configuring || nv != 1 || v[0] > MOST) return 3;
    unit->n = v[0];
    return 0;
}
E int fmi3SetFloat64(void *u, const uint32_t *r, size_t n, const double *v, size_t nv) {
    Unit *unit = u;
    if (r[0] == 5) return unit->speed = v[0], 0;
    if (r[0] != 2 || nv != unit->n) return 3;
    for (size_t i = 0; i < nv; i++) unit->u[i] = v[i];
    return 0;
}
E int fmi3GetFloat64(void *u, const uint32_t *r, size_t n, double *v, size_t nv) {
    Unit *unit = u;
    if (r[0] == 6) return v[0] = unit->wear, 0;
    if (r[0] == 8) return v[0] = unit->speed, 0;
    if (r[0] != 3 || nv != unit->n) return 3;
    for (size_t i = 0; i < nv; i++) v[i] = unit->gain * unit->u[i];
    return 0;
}
E int fmi3GetString(void *u, const uint32_t *r, size_t n, const char **v, size_t nv) {
    Unit *unit = u;
    if (r[0] != 4 || nv != 1) return 3;
    const char *few = unit->called[0] ? unit->called : unit->n > 2 ? "many" : "few";
    snprintf(unit->text, sizeof unit->text, "%ld steps, \"%s\"", unit->steps, few);
    v[0] = unit->text;
    return 0;
}
E int fmi3SetString(void *u, const uint32_t *r, size_t n, const char *const *v, size_t nv) {
    if (r[0] != 7 || nv != 1) return 3;
    snprintf(((Unit *)u)->called, sizeof ((Unit *)u)->called, "%s", v[0]);
    return 0;
}
E int fmi3DoStep(void *u, double time, double step, bool no, bool *event, bool *end, bool *early, double *last) {
    Unit *unit = u;
    double off = time - unit->time;
    *event = *end = *early = false;
    if (off > 1e-9 || off < -1e-9) return 3;
#ifdef DISCARD
    if (step > DISCARD) return 2;
    unit->wear += 1e-6 * unit->speed * step;
#else
    if (step < 0.25 - 1e-9 || step > 0.25 + 1e-9) return 3;
#endif
    unit->time = *last = time + step;
#ifdef REACHED
    *last = REACHED;
#endif
    unit->steps++;
    return 0;
}

E int fmi3Terminate(void *u) { return 0; }

/* What an importer looks for and this unit does not do. */
#define NONE(name) E int name(void) { return 3; }
#ifdef EXCHANGE
#ifndef STATES
#define STATES 1
#endif
#ifndef INDICATORS
#define INDICATORS 0
#endif
#ifndef NOMINAL
#define NOMINAL 1
#endif
E void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *path, bool visible, bool logging,
                                     void *environment, void *log) {
    return fmi3InstantiateCoSimulation(name, token, path, visible, logging, false, false, NULL, 0, environment, log, NULL);
}
E int fmi3EnterEventMode(void *u) { return 0; }
E int fmi3EnterContinuousTimeMode(void *u) { return 0; }
E int fmi3UpdateDiscreteStates(void *u, bool *again, bool *end, bool *nominals, bool *values, bool *defined, double *next) {
    *again = *end = *nominals = *values = *defined = false;
    return 0;
}
E int fmi3GetNumberOfContinuousStates(void *u, size_t *n) { return *n = STATES, 0; }
E int fmi3GetNumberOfEventIndicators(void *u, size_t *n) { return *n = INDICATORS, 0; }
E int fmi3SetTime(void *u, double time) { return ((Unit *)u)->time = time, 0; }
E int fmi3SetContinuousStates(void *u, const double *x, size_t n) { return ((Unit *)u)->wear = x[0], 0; }
E int fmi3GetContinuousStates(void *u, double *x, size_t n) { return x[0] = ((Unit *)u)->wear, 0; }
E int fmi3GetNominalsOfContinuousStates(void *u, double *x, size_t n) { return x[0] = NOMINAL, 0; }
E int fmi3GetContinuousStateDerivatives(void *u, double *d, size_t n) { return d[0] = ((Unit *)u)->speed, 0; }
NONE(fmi3GetEventIndicators) NONE(fmi3CompletedIntegratorStep)
#else
NONE(fmi3EnterEventMode) NONE(fmi3UpdateDiscreteStates)
#endif
NONE(fmi3SetDebugLogging) NONE(fmi3Reset) NONE(fmi3GetFloat32)
NONE(fmi3GetInt8) NONE(fmi3GetUInt8) NONE(fmi3GetInt16) NONE(fmi3GetUInt16) NONE(fmi3GetInt32) NONE(fmi3GetUInt32)
NONE(fmi3GetInt64) NONE(fmi3GetUInt64) NONE(fmi3GetBoolean) NONE(fmi3GetBinary) NONE(fmi3GetClock)
NONE(fmi3SetFloat32) NONE(fmi3SetInt8) NONE(fmi3SetUInt8) NONE(fmi3SetInt16) NONE(fmi3SetUInt16) NONE(fmi3SetInt32)
NONE(fmi3SetUInt32) NONE(fmi3SetInt64) NONE(fmi3SetBoolean) NONE(fmi3SetBinary)
NONE(fmi3SetClock) NONE(fmi3GetNumberOfVariableDependencies) NONE(fmi3GetVariableDependencies) NONE(fmi3GetFMUState)
NONE(fmi3SetFMUState) NONE(fmi3FreeFMUState) NONE(fmi3SerializedFMUStateSize) NONE(fmi3SerializeFMUState)
NONE(fmi3DeserializeFMUState) NONE(fmi3GetDirectionalDerivative) NONE(fmi3GetAdjointDerivative)
NONE(fmi3GetIntervalDecimal) NONE(fmi3GetIntervalFraction) NONE(fmi3GetShiftDecimal) NONE(fmi3GetShiftFraction)
NONE(fmi3SetIntervalDecimal) NONE(fmi3SetIntervalFraction) NONE(fmi3SetShiftDecimal) NONE(fmi3SetShiftFraction)
NONE(fmi3EvaluateDiscreteStates) NONE(fmi3EnterStepMode)
NONE(fmi3GetOutputDerivatives)
