/* A unit of FMI 2.0 in one file: wear grows with speed, and it does on demand what units do wrong.
   Compiled by the tests with -D switches:
   FAILS   steps fail from 100 s on          NO_STEP  fmi2DoStep is missing
   TIRES   steps fail after as many as it says, whatever the instance
   DENIES  no instance is made               LOUD     messages without category, with %s
   STATES  only as many saved states as it says are alive at one time, of all instances
   UNITS   only as many instances as it says are alive at one time
   VALUE   the wear that it tells of, mm, from 100 s on
   GAIN    in place of its wear a multiple of its speed in m/min, at once
   BEFORE  an expression that is evaluated before each step from 100 s on, such as a crash; MAKES, ENTERS, EXITS, SETS,
   ENDS, FREES  the same as it is instantiated, enters and exits Initialization Mode, is given a real, is terminated, freed
   SIZE    the bytes that it says its saved state takes
   DISCARD longest step that it takes, s; TERMINATE  the time at which it ends the simulation, s
   BEHIND  with DISCARD: it took nothing of a step that it discards, and its own time is behind by rounding
   LAST    a path: fmi2Terminate writes a line with the time there; UNENDED  fmi2Terminate fails
   MARKER  a path: where such a file is, it is removed and the reading of a value fails
   EXCHANGE  Model Exchange in place of Co-Simulation: wear is a state, its limit a state event; TICK  from this time on,
   s, a time event, the unit wears twice as fast; CALLS  a step event after so many steps of the integrator;
   REFUSES  no derivatives after this time, s; UNDEFINED  derivatives that are no numbers from this time on, s;
   STIFF  equations for an implicit integrator */
#include <math.h>
#include <signal.h>
#include <unistd.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    void (*log)(void *, const char *, int, const char *, const char *, ...);
    void *allocate, *release, *finished, *environment;
} Callbacks;

typedef struct {
    double time, speed, wear, rate;
    int engaged, worn, ticked, steps;
} State;

typedef struct {
    State state;
    const Callbacks *callbacks;
} Unit;

static const State START = {0.0, 0.5, 0.0, 1e-6, 1};

static int units;
static double last, ended;

#ifndef MAKES
#define MAKES
#endif
#ifndef ENTERS
#define ENTERS
#endif
#ifndef EXITS
#define EXITS
#endif
#ifndef SETS
#define SETS
#endif
#ifndef ENDS
#define ENDS
#endif
#ifndef FREES
#define FREES
#endif
#ifndef SIZE
#define SIZE sizeof(State)
#endif

/* Runs out of stack. */
static int overflow(int n) {
    volatile char much[4096];
    much[0] = n;
    return overflow(n + 1) + much[0];
}

#define E __attribute__((visibility("default")))

static int refuse(Unit *unit, const char *text) {
    const Callbacks *c = unit->callbacks;
#ifdef LOUD
    c->log(c->environment, "wear", 3, NULL, "%s", text);
#else
    c->log(c->environment, "wear", 3, "logAll", text);
#endif
    return 3;
}

E const char *fmi2GetTypesPlatform(void) { return "default"; }
E const char *fmi2GetVersion(void) { return "2.0"; }
E int fmi2SetDebugLogging(void *u, int on, size_t n, const char *const *c) { return 0; }
E void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const Callbacks *callbacks,
                        int visible, int logging) {
#ifdef DENIES
    callbacks->log(callbacks->environment, name, 3, "logAll", "the licence has run out");
    return NULL;
#endif
    MAKES;
    if (strcmp(guid, "{wear}")) return NULL;
#ifdef UNITS
    if (__atomic_add_fetch(&units, 1, __ATOMIC_RELAXED) > UNITS) {
        callbacks->log(callbacks->environment, name, 3, "logAll", "too many instances");
        return NULL;
    }
#endif
    Unit *unit = calloc(1, sizeof(Unit));
    unit->state = START;
    unit->callbacks = callbacks;
    return unit;
}
E void fmi2FreeInstance(void *u) {
    FREES;
    __atomic_sub_fetch(&units, 1, __ATOMIC_RELAXED);
    free(u);
}
E int fmi2SetupExperiment(void *u, int t, double tolerance, double start, int s, double stop) {
    ((Unit *)u)->state.time = start;
    return 0;
}
E int fmi2EnterInitializationMode(void *u) {
    ENTERS;
    return 0;
}
E int fmi2ExitInitializationMode(void *u) {
    EXITS;
    return 0;
}
E int fmi2Terminate(void *u) {
    ENDS;
#ifdef LAST
    FILE *file = fopen(LAST, "a");
    fprintf(file, "%g\n", ((Unit *)u)->state.time);
    fclose(file);
#endif
#ifdef UNENDED
    return refuse(u, "the results are lost");
#endif
    return 0;
}
E int fmi2Reset(void *u) {
    ((Unit *)u)->state = START;
    return 0;
}
#ifdef MARKER
#define MARKED if (!unlink(MARKER)) return 3
#else
#define MARKED
#endif
E int fmi2GetReal(void *u, const unsigned *r, size_t n, double *v) {
    State *s = &((Unit *)u)->state;
    MARKED;
    for (size_t i = 0; i < n; i++) v[i] = r[i] == 1 ? s->speed * 60 : r[i] == 2 ? s->wear * 1e3 : s->rate;
#ifdef GAIN
    for (size_t i = 0; i < n; i++) if (r[i] == 2) v[i] = GAIN * s->speed * 60;
#endif
#ifdef VALUE
    for (size_t i = 0; i < n; i++) if (r[i] == 2 && s->time > 100) v[i] = VALUE;
#endif
    return 0;
}
E int fmi2SetReal(void *u, const unsigned *r, size_t n, const double *v) {
    SETS;
    State *s = &((Unit *)u)->state;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == 1) s->speed = v[i] / 60;
        else if (r[i] == 3) s->rate = v[i];
        else return refuse(u, "no such input");
    }
    return 0;
}
E int fmi2GetBoolean(void *u, const unsigned *r, size_t n, int *v) {
    State *s = &((Unit *)u)->state;
    MARKED;
    for (size_t i = 0; i < n; i++) v[i] = r[i] == 4 ? s->engaged : s->worn;
    return 0;
}
E int fmi2SetBoolean(void *u, const unsigned *r, size_t n, const int *v) {
    for (size_t i = 0; i < n; i++) ((Unit *)u)->state.engaged = v[i];
    return 0;
}
E int fmi2GetInteger(void *u, const unsigned *r, size_t n, int *v) { return 3; }
E int fmi2GetString(void *u, const unsigned *r, size_t n, const char **v) { return 3; }
E int fmi2SetInteger(void *u, const unsigned *r, size_t n, const int *v) { return 3; }
E int fmi2SetString(void *u, const unsigned *r, size_t n, const char *const *v) { return 3; }
static int alive;
/* Memory for one more saved state. */
static void *one_more(Unit *unit) {
#ifdef STATES
    if (__atomic_add_fetch(&alive, 1, __ATOMIC_RELAXED) > STATES) {
        refuse(unit, "too many saved states");
        return NULL;
    }
#endif
    return malloc(sizeof(State));
}
E int fmi2GetFMUstate(void *u, void **s) {
    if (!*s && !(*s = one_more(u))) return 3;
    memcpy(*s, &((Unit *)u)->state, sizeof(State));
    return 0;
}
E int fmi2SetFMUstate(void *u, void *s) {
    memcpy(&((Unit *)u)->state, s, sizeof(State));
    return 0;
}
E int fmi2FreeFMUstate(void *u, void **s) {
    if (*s) __atomic_sub_fetch(&alive, 1, __ATOMIC_RELAXED);
    free(*s);
    *s = NULL;
    return 0;
}
E int fmi2SerializedFMUstateSize(void *u, void *s, size_t *n) {
    *n = SIZE;
    return 0;
}
E int fmi2SerializeFMUstate(void *u, void *s, char *b, size_t n) {
    memcpy(b, s, n);
    return 0;
}
E int fmi2DeSerializeFMUstate(void *u, const char *b, size_t n, void **s) {
    if (n != sizeof(State)) return 3;
    /* The standard has it make a copy: what the pointer held before is the importer's. */
    if (!(*s = one_more(u))) return 3;
    memcpy(*s, b, n);
    return 0;
}
E int fmi2GetDirectionalDerivative(void *u, const unsigned *z, size_t nz, const unsigned *v, size_t nv, const double *d,
                                   double *o) { return 3; }
E int fmi2SetRealInputDerivatives(void *u, const unsigned *r, size_t n, const int *o, const double *v) { return 3; }
E int fmi2GetRealOutputDerivatives(void *u, const unsigned *r, size_t n, const int *o, double *v) { return 3; }
#ifdef EXCHANGE
typedef struct { int again, terminate, nominals, values, defined; double next; } EventInfo;
#ifndef TICK
#define TICK 1e300
#endif
E int fmi2EnterEventMode(void *u) { return 0; }
E int fmi2EnterContinuousTimeMode(void *u) { return 0; }
E int fmi2NewDiscreteStates(void *u, EventInfo *e) {
    State *s = &((Unit *)u)->state;
    int due = !s->ticked && s->time >= TICK;
    memset(e, 0, sizeof *e);
    if (due) s->rate *= 2, s->ticked = 1;
    s->worn = !(0.3e-3 - s->wear > 0);
    e->again = due;
    if ((e->defined = !s->ticked)) e->next = TICK;
#ifdef TERMINATE
    e->terminate = s->time >= TERMINATE;
    if (s->time < TERMINATE && (!e->defined || TERMINATE < TICK)) e->defined = 1, e->next = TERMINATE;
#endif
    return 0;
}
E int fmi2CompletedIntegratorStep(void *u, int no, int *event, int *end) {
    State *s = &((Unit *)u)->state;
    *event = *end = 0;
#ifdef CALLS
    *event = ++s->steps % CALLS == 0;
#endif
    return 0;
}
E int fmi2SetTime(void *u, double t) {
    ((Unit *)u)->state.time = t;
    return 0;
}
E int fmi2SetContinuousStates(void *u, const double *x, size_t n) {
    ((Unit *)u)->state.wear = x[0];
    return 0;
}
E int fmi2GetContinuousStates(void *u, double *x, size_t n) {
    x[0] = ((Unit *)u)->state.wear;
    return 0;
}
E int fmi2GetNominalsOfContinuousStates(void *u, double *x, size_t n) {
    x[0] = 1e-3;
    return 0;
}
E int fmi2GetDerivatives(void *u, double *d, size_t n) {
    State *s = &((Unit *)u)->state;
#ifdef REFUSES
    if (s->time > REFUSES) return 2;
#endif
#ifdef STIFF
    d[0] = -1e9 * (s->wear - 1e-4 * s->time);
    return 0;
#endif
    d[0] = s->engaged ? s->rate * s->speed : 0;
#ifdef UNDEFINED
    if (s->time >= UNDEFINED) d[0] = NAN;
#endif
    return 0;
}
E int fmi2GetEventIndicators(void *u, double *z, size_t n) {
    z[0] = 0.3e-3 - ((Unit *)u)->state.wear;
    return 0;
}
#endif
#ifndef NO_STEP
E int fmi2DoStep(void *u, double time, double step, int prior) {
    State *s = &((Unit *)u)->state;
    double off = time - s->time;
    if (off > 1e-9 * (1 + time) || off < -1e-9 * (1 + time)) return refuse(u, "the time is another");
#ifdef TIRES
    static int steps;
    if (++steps > TIRES) return refuse(u, "no more steps today");
#endif
#ifdef BEFORE
    if (time + step > 100) { BEFORE; }
#endif
#ifdef DISCARD
    last = time + (step > DISCARD ? DISCARD : step);
#ifdef BEHIND
    last = nextafter(time, 0);
#endif
    if (step > DISCARD) return 2;
#endif
#ifdef TERMINATE
    last = TERMINATE;
    if ((ended = time + step > TERMINATE)) {
        s->time = TERMINATE;
        return 2;
    }
#endif
#ifdef FAILS
    if (time + step > 100) return refuse(u, "the solver gave up");
#endif
    if (s->engaged) s->wear += s->rate * s->speed * step;
    s->worn = s->wear >= 0.3e-3;
    s->time = time + step;
    return 0;
}
#endif
E int fmi2CancelStep(void *u) { return 3; }
E int fmi2GetStatus(void *u, int k, int *v) { return 2; }
E int fmi2GetRealStatus(void *u, int k, double *v) {
    *v = last;
    return k == 2 ? 0 : 2;
}
E int fmi2GetIntegerStatus(void *u, int k, int *v) { return 2; }
E int fmi2GetBooleanStatus(void *u, int k, int *v) {
    *v = ended;
    return k == 3 ? 0 : 2;
}
E int fmi2GetStringStatus(void *u, int k, const char **v) { return 2; }
